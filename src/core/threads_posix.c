/* SPDX-License-Identifier: Apache-2.0 */
/* C11 threads on top of POSIX threads, in place of the C library's. Only for builds with the thread
 * sanitizer, which crashes in C11 threads. Relies on both having the same types, as in glibc.
 * Source: ISO/IEC 9899:2018, 7.26. */
#include <errno.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <threads.h>

_Static_assert(sizeof(thrd_t) == sizeof(pthread_t), "thrd_t is pthread_t");
_Static_assert(sizeof(mtx_t) == sizeof(pthread_mutex_t), "mtx_t holds a pthread_mutex_t");
_Static_assert(sizeof(cnd_t) == sizeof(pthread_cond_t), "cnd_t holds a pthread_cond_t");

typedef struct beginning {
    thrd_start_t run;
    void *argument;
} beginning;

static void *begin(void *given) {
    beginning b = *(beginning *)given;
    free(given);
    return (void *)(intptr_t)b.run(b.argument);
}

static int status_of(int error) {
    return error == 0 ? thrd_success : error == ETIMEDOUT ? thrd_timedout : thrd_error;
}

int thrd_create(thrd_t *thread, thrd_start_t run, void *argument) {
    beginning *b = malloc(sizeof *b);
    if (b == NULL)
        return thrd_nomem;
    *b = (beginning){run, argument};
    int error = pthread_create(thread, NULL, begin, b);
    if (error != 0)
        free(b);
    return status_of(error);
}

int thrd_join(thrd_t thread, int *result) {
    void *value = NULL;
    int error = pthread_join(thread, &value);
    if (error == 0 && result != NULL)
        *result = (int)(intptr_t)value;
    return status_of(error);
}

static pthread_mutex_t *mutex_of(mtx_t *mutex) {
    return (pthread_mutex_t *)(void *)mutex;
}

static pthread_cond_t *condition_of(cnd_t *condition) {
    return (pthread_cond_t *)(void *)condition;
}

int mtx_init(mtx_t *mutex, int type) {
    return type & mtx_recursive ? thrd_error : status_of(pthread_mutex_init(mutex_of(mutex), NULL));
}

void mtx_destroy(mtx_t *mutex) {
    pthread_mutex_destroy(mutex_of(mutex));
}

int mtx_lock(mtx_t *mutex) {
    return status_of(pthread_mutex_lock(mutex_of(mutex)));
}

int mtx_timedlock(mtx_t *restrict mutex, const struct timespec *restrict until) {
    return status_of(pthread_mutex_timedlock(mutex_of(mutex), until));
}

int mtx_unlock(mtx_t *mutex) {
    return status_of(pthread_mutex_unlock(mutex_of(mutex)));
}

int cnd_init(cnd_t *condition) {
    return status_of(pthread_cond_init(condition_of(condition), NULL));
}

void cnd_destroy(cnd_t *condition) {
    pthread_cond_destroy(condition_of(condition));
}

int cnd_broadcast(cnd_t *condition) {
    return status_of(pthread_cond_broadcast(condition_of(condition)));
}

int cnd_signal(cnd_t *condition) {
    return status_of(pthread_cond_signal(condition_of(condition)));
}

int cnd_wait(cnd_t *condition, mtx_t *mutex) {
    return status_of(pthread_cond_wait(condition_of(condition), mutex_of(mutex)));
}

int cnd_timedwait(cnd_t *restrict condition, mtx_t *restrict mutex,
                  const struct timespec *restrict until) {
    return status_of(pthread_cond_timedwait(condition_of(condition), mutex_of(mutex), until));
}

void call_once(once_flag *flag, void (*run)(void)) {
    pthread_once((pthread_once_t *)(void *)flag, run);
}
