/* Stage 3 of the direction grid for any processor. */
#define GRID_TEST_FACES grid_test_faces_plain
#define LANES_PLAIN
#include "visibility/grid_faces.h"
