/* SPDX-License-Identifier: Apache-2.0 */
#include "database.h"

#include <errno.h>
#include <string.h>

static starg_status fail(const cli_csv *csv, int error) {
    return cli_fail(csv->session, STARG_ERROR_WRITE, "cannot write '%s': %s", csv->name,
                    strerror(error));
}

starg_status cli_csv_open(cli_session *session, const char *name, cli_csv *csv) {
    *csv = (cli_csv){.session = session, .name = name};
    csv->stream =
        strcmp(name, "-") == 0 ? stdout : fopen(cli_outputs_place(&session->outputs, name), "wb");
    return csv->stream != NULL ? STARG_OK : fail(csv, errno);
}

static void begin_field(cli_csv *csv) {
    if (csv->line_begun)
        fputc(',', csv->stream);
    csv->line_begun = true;
}

void cli_csv_text(cli_csv *csv, const char *text) {
    begin_field(csv);
    if (strpbrk(text, ",\"\r\n") == NULL) {
        fputs(text, csv->stream);
        return;
    }
    fputc('"', csv->stream);
    for (; *text != '\0'; text++)
        fprintf(csv->stream, *text == '"' ? "\"\"" : "%c", *text);
    fputc('"', csv->stream);
}

void cli_csv_real(cli_csv *csv, double value) {
    begin_field(csv);
    fprintf(csv->stream, "%.17g", value);
}

void cli_csv_end_line(cli_csv *csv) {
    fputc('\n', csv->stream);
    csv->line_begun = false;
}

starg_status cli_csv_close(cli_csv *csv) {
    errno = 0;
    bool broken = fflush(csv->stream) != 0 || ferror(csv->stream) != 0;
    int error = errno;
    if (csv->stream != stdout && fclose(csv->stream) != 0 && !broken) {
        broken = true;
        error = errno;
    }
    return broken ? fail(csv, error != 0 ? error : EIO) : STARG_OK;
}

char *cli_csv_field(char **at) {
    char *begin = *at, *from = *at, *to = *at;
    if (begin == NULL)
        return NULL;
    bool quoted = *from == '"';
    from += quoted;
    while (*from != '\0' && (quoted || *from != ',')) {
        if (quoted && *from == '"' && *++from != '"') {
            quoted = false;
            continue;
        }
        *to++ = *from++;
    }
    *at = *from == ',' ? from + 1 : NULL;
    *to = '\0';
    return begin;
}
