/* SPDX-License-Identifier: Apache-2.0 */
/* _keywords.pyi: the types of the Python package's keyword arguments, for type checkers and
 * editors. At run time the package reads the tables directly. */
#include <string.h>

#include "fields.h"

static void put_type(FILE *stub, const starg_field *f) {
    static const char *const names[] = {[STARG_FIELD_FLAG] = "bool",
                                        [STARG_FIELD_COUNT] = "SupportsIndex",
                                        [STARG_FIELD_REAL] = "SupportsFloat",
                                        [STARG_FIELD_TEXT] = "PathLike",
                                        [STARG_FIELD_NUMBERS] = "Iterable[SupportsFloat]"};
    if (f->kind != STARG_FIELD_CHOICE)
        fprintf(stub, "%s | ", names[f->kind]);
    if (f->words == NULL) {
        fputs("None\n", stub);
        return;
    }
    fputs("Literal[", stub);
    for (size_t i = 0; f->words[i] != NULL; i++)
        fprintf(stub, "%s\"%s\"", i > 0 ? ", " : "", f->words[i]);
    fputs("] | None\n", stub);
}

static void put_argument(FILE *stub, const call *c, const starg_field *f) {
    char name[NAME_SIZE];
    keyword_name(f, name);
    bool taken = f->kind <= STARG_FIELD_TEXT || f->kind == STARG_FIELD_NUMBERS;
    if (!taken || (c->without != NULL && strcmp(name, c->without) == 0))
        return;
    fprintf(stub, "    %s: ", name);
    put_type(stub, f);
}

bool write_keywords(const char *path) {
    FILE *stub = fopen(path, "w");
    if (stub == NULL)
        return false;
    fputs("from typing import Iterable, Literal, SupportsFloat, SupportsIndex, TypedDict\n\n"
          "from ._types import PathLike\n",
          stub);
    for (size_t i = 0; i < call_count; i++) {
        const call *c = &calls[i];
        fprintf(stub, "\nclass %s(TypedDict, total=False):\n", c->keywords);
        for (size_t k = 0; k < c->fields()->count; k++)
            put_argument(stub, c, &c->fields()->fields[k]);
    }
    bool written = !ferror(stub);
    return fclose(stub) == 0 && written;
}
