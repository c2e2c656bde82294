/* SPDX-License-Identifier: Apache-2.0 */
/* Greedy set cover [Joh74] with lazy evaluation: needs never grow while rows are added, so a heap
 * of stale needs is enough: the top row is re-evaluated and either stays on top or sinks. Cost: one
 * pass over the ones of the matrix, then a few rows per choice. */
#include "cover/cover.h"

typedef struct heap_entry {
    uint64_t need;
    uint32_t row;
} heap_entry;

static bool goes_first(heap_entry a, heap_entry b) {
    return a.need != b.need ? a.need > b.need : a.row < b.row;
}

static void sink(heap_entry *heap, size_t count, size_t at) {
    heap_entry moved = heap[at];
    for (size_t child; (child = 2 * at + 1) < count; at = child) {
        if (child + 1 < count && goes_first(heap[child + 1], heap[child]))
            child++;
        if (!goes_first(heap[child], moved))
            break;
        heap[at] = heap[child];
    }
    heap[at] = moved;
}

static size_t make_heap(const cover_state *state, heap_entry *heap) {
    size_t count = 0;
    for (size_t i = 0; i < state->instance->rows; i++) {
        if (!starg_bit_test(state->taken, i))
            heap[count++] = (heap_entry){cover_state_need(state, i), (uint32_t)i};
    }
    for (size_t i = count / 2; i-- > 0;)
        sink(heap, count, i);
    return count;
}

starg_status cover_greedy(cover_run *run, cover_state *state, uint64_t goal, size_t limit) {
    SCOPED heap_entry *heap = NULL;
    NEW(run->context, "cover", heap, state->instance->rows);
    size_t count = make_heap(state, heap);
    while (state->weight < goal && state->count < limit && count != 0) {
        TRY(starg_check_cancel(run->context, "cover"));
        uint64_t fresh = cover_state_need(state, heap[0].row);
        if (fresh == heap[0].need) {
            if (fresh == 0)
                break;
            cover_state_add(state, heap[0].row);
            heap[0] = heap[--count];
        } else {
            heap[0].need = fresh;
        }
        if (count != 0)
            sink(heap, count, 0);
    }
    return STARG_OK;
}

/* Position of the chosen row of least loss; ties go to the highest index. */
static size_t least_loss(const cover_state *state, uint64_t *loss) {
    size_t best = 0;
    *loss = UINT64_MAX;
    for (size_t p = 0; p < state->count; p++) {
        uint64_t own = cover_state_loss(state, state->rows[p]);
        if (own < *loss || (own == *loss && state->rows[p] > state->rows[best])) {
            *loss = own;
            best = p;
        }
    }
    return best;
}

void cover_drop_needless(cover_state *state, uint64_t goal) {
    while (state->count != 0) {
        uint64_t loss;
        size_t position = least_loss(state, &loss);
        if (state->weight - loss < goal)
            break;
        cover_state_remove(state, position);
    }
}

starg_status cover_shrink(cover_run *run, cover_state *state, uint64_t goal) {
    SCOPED_BY(cover_state_free) cover_state trial = {0};
    TRY(cover_state_create(state->instance, &trial));
    while (state->count > 1 && !cover_time_is_over(run)) {
        uint64_t loss;
        cover_state_copy(&trial, state);
        cover_state_remove(&trial, least_loss(&trial, &loss));
        TRY(cover_swap(run, &trial, goal));
        if (trial.weight < goal)
            break;
        cover_drop_needless(&trial, goal);
        cover_state_copy(state, &trial);
    }
    return STARG_OK;
}
