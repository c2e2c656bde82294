/* Stage 3 of the direction grid for AVX2 with FMA. */
#define GRID_TEST_FACES grid_test_faces_avx2
#define LANES_AVX2
#include "visibility/grid_faces.h"
