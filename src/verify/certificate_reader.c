/* SPDX-License-Identifier: Apache-2.0 */
/* The words of a certificate. */
#include "verify/certificate_reader.h"

#include <math.h>
#include <stdio.h>

static const char STAGE[] = "certificate";

enum { CANCEL_STEP = 1 << 16 };

starg_status certificate_reject(const certificate_reader *r, const char *what) {
    uint64_t line = r->line;
    return starg_fail_at(r->context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_LINE, &line, 1,
                         "'%.200s', line %llu: %s", r->name, (unsigned long long)line, what);
}

bool certificate_take(certificate_reader *r, char c) {
    bool taken = r->at < r->end && *r->at == c;
    r->at += taken;
    return taken;
}

starg_status certificate_take_text(certificate_reader *r, const char *text) {
    char message[64];
    const char *at = r->at;
    for (const char *c = text; *c != '\0'; c++, at++)
        if (at == r->end || *at != *c) {
            snprintf(message, sizeof message, "\"%s\" is expected here", text);
            return certificate_reject(r, message);
        }
    r->at = at;
    return STARG_OK;
}

starg_status certificate_end_line(certificate_reader *r) {
    if (!certificate_take(r, '\n'))
        return certificate_reject(r, r->at == r->end
                                         ? "the file ends within the line"
                                         : "the line goes on where its end is expected");
    r->line++;
    if (r->line % CANCEL_STEP == 0)
        return starg_check_cancel(r->context, STAGE);
    return STARG_OK;
}

/* A whole number of at most `most`, without a sign and without needless zeros. */
starg_status certificate_take_number(certificate_reader *r, uint64_t most, uint64_t *value) {
    const char *begin = r->at;
    char message[128];
    *value = 0;
    while (r->at < r->end && *r->at >= '0' && *r->at <= '9' && r->at - begin < 19)
        *value = 10 * *value + (uint64_t)(*r->at++ - '0');
    if (r->at == begin || (*begin == '0' && r->at - begin > 1))
        return certificate_reject(r, "a whole number is expected here");
    if (*value > most) {
        snprintf(message, sizeof message,
                 "%llu is out of range: %llu is the most that may stand here",
                 (unsigned long long)*value, (unsigned long long)most);
        return certificate_reject(r, message);
    }
    return STARG_OK;
}

/* A number of things of at least `size` bytes each, which are still to come. */
starg_status certificate_take_count(certificate_reader *r, const char *word, size_t size,
                                    size_t *count) {
    starg_status status = STARG_OK;
    uint64_t value;
    STARG_TRY(certificate_take_text(r, word));
    STARG_TRY(certificate_take_number(r, (uint64_t)(r->end - r->at) / size, &value));
    *count = (size_t)value;
    STARG_TRY(certificate_end_line(r));
done:
    return status;
}

/* M:K is M times 2 to the power of K. */
starg_status certificate_take_double(certificate_reader *r, double *value) {
    starg_status status = STARG_OK;
    uint64_t whole, power;
    bool negative = certificate_take(r, '-');
    STARG_TRY(certificate_take_number(r, UINT64_C(1) << 53, &whole));
    STARG_TRY(certificate_take_text(r, ":"));
    bool small = certificate_take(r, '-');
    STARG_TRY(certificate_take_number(r, 1074, &power));
    double size = ldexp((double)whole, small ? -(int)power : (int)power);
    if (!(size < 1e100))
        return certificate_reject(r, "numbers are below 1e100 in magnitude");
    *value = negative ? -size : size;
done:
    return status;
}

starg_status certificate_take_point(certificate_reader *r, double out[3]) {
    starg_status status = STARG_OK;
    for (int k = 0; k < 3; k++) {
        STARG_TRY(certificate_take_text(r, " "));
        STARG_TRY(certificate_take_double(r, &out[k]));
    }
done:
    return status;
}
