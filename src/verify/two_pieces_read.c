/* SPDX-License-Identifier: Apache-2.0 */
/* Reads the points and pairs of a certificate that two pieces are not enough (docs/formats.md). The
 * tree is complete if nothing is left at its end. */
#include <math.h>

#include "verify/certificate_reader.h"

static const char STAGE[] = "certificate";

/* Boxes that are still to come, the next one on top. */
typedef struct open_pair {
    verify_box box[2];
    bool same; /* both boxes are the same place */
    int depth;
} open_pair;

typedef STARG_ARRAY(open_pair) open_pairs;

static starg_status read_points(certificate_reader *r) {
    starg_status status = STARG_OK;
    size_t count;
    STARG_TRY(certificate_take_count(r, "points ", 12, &count));
    for (size_t i = 0; i < count; i++) {
        double point[3];
        STARG_TRY(certificate_take_text(r, "point"));
        STARG_TRY(certificate_take_point(r, point));
        STARG_TRY(certificate_end_line(r));
        for (int k = 0; k < 3; k++)
            STARG_PUSH(r->context, STAGE, &r->own->points, point[k]);
    }
done:
    return status;
}

/* Number of something of which there are `count`. */
static starg_status take_index(certificate_reader *r, size_t count, uint32_t *out) {
    starg_status status = STARG_OK;
    uint64_t value;
    if (count == 0)
        return certificate_reject(r, "there is none of these");
    STARG_TRY(certificate_take_number(r, count - 1, &value));
    *out = (uint32_t)value;
done:
    return status;
}

static starg_status read_leaf(certificate_reader *r, const open_pair *of, char kind) {
    starg_status status = STARG_OK;
    everywhere_pair leaf = {.box = {of->box[0], of->box[1]}, .kind = kind, .line = (size_t)r->line};
    const size_t faces = r->own->face_count;
    STARG_TRY(take_index(r,
                         kind == 'o'   ? 2
                         : kind == 'f' ? faces
                                       : r->own->points.count / 3,
                         &leaf.number));
    for (int i = 0; i < 2 && kind == 'p'; i++) {
        STARG_TRY(certificate_take_text(r, ":"));
        STARG_TRY(take_index(r, faces, &leaf.seeds[i]));
    }
    STARG_PUSH(r->context, STAGE, &r->own->leaves, leaf);
done:
    return status;
}

static void halve(const verify_box *box, int axis, verify_box halves[2]) {
    double lower = box->lower[axis], upper = box->upper[axis];
    halves[0] = halves[1] = *box;
    halves[0].upper[axis] = halves[1].lower[axis] =
        fmin(fmax(0.5 * lower + 0.5 * upper, lower), upper);
}

/* The first box, the second, or both if they are the same. */
static starg_status read_halves(certificate_reader *r, const open_pair *of, char which,
                                open_pairs *open) {
    starg_status status = STARG_OK;
    verify_box h[2];
    const int axis = certificate_take(r, 'x')   ? 0
                     : certificate_take(r, 'y') ? 1
                     : certificate_take(r, 'z') ? 2
                                                : -1;
    if (axis < 0)
        return certificate_reject(r, "x, y or z is expected here");
    if ((which == '=') != of->same)
        return certificate_reject(r, "boxes are halved together exactly if they are the same");
    if (of->depth > EVERYWHERE_DEPTH)
        return certificate_reject(r, "boxes are halved too often");
    halve(&of->box[which == '1'], axis, h);
    const int depth = of->depth + 1;
    if (which == '=') {
        STARG_PUSH(r->context, STAGE, open, ((open_pair){{h[1], h[1]}, true, depth}));
        STARG_PUSH(r->context, STAGE, open, ((open_pair){{h[0], h[1]}, false, depth}));
        STARG_PUSH(r->context, STAGE, open, ((open_pair){{h[0], h[0]}, true, depth}));
        return STARG_OK;
    }
    for (int i = 1; i >= 0; i--) {
        open_pair half = {{of->box[0], of->box[1]}, false, depth};
        half.box[which == '1'] = h[i];
        STARG_PUSH(r->context, STAGE, open, half);
    }
done:
    return status;
}

static starg_status read_pair(certificate_reader *r, open_pairs *open) {
    starg_status status = STARG_OK;
    if (open->count == 0)
        return certificate_reject(r, "the pairs before this one are all: none may follow");
    const open_pair next = open->data[--open->count];
    const char letter = r->at < r->end ? *r->at : '\0';
    r->at += r->at < r->end;
    if (letter == '0' || letter == '1' || letter == '=')
        STARG_TRY(read_halves(r, &next, letter, open));
    else if (letter == 'o' || letter == 'f' || letter == 'p')
        STARG_TRY(read_leaf(r, &next, letter));
    else
        return certificate_reject(r, "a pair is expected here: 0, 1, =, o, f or p");
    STARG_TRY(certificate_end_line(r));
done:
    return status;
}

starg_status certificate_read_pairs(certificate_reader *r, const verify_box *root) {
    starg_status status = STARG_OK;
    open_pairs open = {0};
    size_t count;
    r->own->root = *root;
    STARG_TRY(read_points(r));
    STARG_TRY(certificate_take_count(r, "pairs ", 3, &count));
    STARG_PUSH(r->context, STAGE, &open, ((open_pair){{*root, *root}, true, 0}));
    for (size_t i = 0; i < count; i++)
        STARG_TRY(read_pair(r, &open));
    if (open.count > 0)
        status = certificate_reject(r, "halves of pairs are missing");
done:
    STARG_ARRAY_FREE(r->context, &open);
    return status;
}
