/* SPDX-License-Identifier: Apache-2.0 */
/* Tags of an XML text, one after another, in linear time. */
#include "mesh/formats/vtk.h"

xml_scan xml_scan_make(const starg_source *source) {
    return (xml_scan){source, source->bytes, source->bytes + source->size, 1};
}

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static void move_to(xml_scan *scan, const char *to) {
    for (; scan->at < to; scan->at++)
        scan->line += *scan->at == '\n';
}

static bool begins(const xml_scan *scan, const char *text) {
    size_t length = strlen(text);
    return (size_t)(scan->end - scan->at) >= length && memcmp(scan->at, text, length) == 0;
}

static starg_status fail_open(const xml_scan *scan, const char *what) {
    return starg_source_fail(scan->source, starg_at_line(scan->line),
                             "%s that begins here does not end; the file seems to be truncated",
                             what);
}

/* Moves behind the next `text`; false if there is none. */
static bool pass(xml_scan *scan, const char *text) {
    xml_scan ahead = *scan;
    while (ahead.at < ahead.end && !begins(&ahead, text))
        move_to(&ahead, ahead.at + 1);
    if (ahead.at == ahead.end)
        return false;
    move_to(&ahead, ahead.at + strlen(text));
    *scan = ahead;
    return true;
}

/* Where a < begins no tag: what ends it; otherwise NULL. */
static const char *end_of_other(const xml_scan *scan) {
    return begins(scan, "<!--") ? "-->"
           : begins(scan, "<?") ? "?>"
           : begins(scan, "<!") ? ">"
                                : NULL;
}

static starg_word word_between(const char *begin, const char *end, size_t line) {
    return (starg_word){begin, (size_t)(end - begin), line};
}

/* From < to >, outside the values of attributes, which may hold that. */
static starg_status take_tag(xml_scan *scan, xml_tag *tag) {
    const char *at = scan->at + 1, *end = scan->end;
    size_t line = scan->line;
    char quote = '\0';
    tag->kind = at < end && *at == '/' ? XML_CLOSE : XML_OPEN;
    at += tag->kind == XML_CLOSE;
    const char *name = at;
    while (at < end && !is_blank(*at) && *at != '>' && *at != '/')
        at++;
    tag->name = word_between(name, at, line);
    name = at;
    for (; at < end && (quote != '\0' || *at != '>'); at++)
        if (quote != '\0' ? *at == quote : *at == '"' || *at == '\'')
            quote = quote != '\0' ? '\0' : *at;
    if (at == end)
        return fail_open(scan, "a tag");
    tag->empty = tag->kind == XML_OPEN && at[-1] == '/';
    tag->attributes = word_between(name, at - tag->empty, line);
    move_to(scan, at + 1);
    return STARG_OK;
}

starg_status xml_next(xml_scan *scan, xml_tag *tag) {
    for (;;) {
        const char *from = scan->at;
        size_t line = scan->line;
        const char *found = from < scan->end ? memchr(from, '<', (size_t)(scan->end - from)) : NULL;
        *tag = (xml_tag){XML_END};
        if (found == NULL)
            return STARG_OK;
        move_to(scan, found);
        const char *other = end_of_other(scan);
        if (other == NULL) {
            tag->before = word_between(from, found, line);
            return take_tag(scan, tag);
        }
        if (!pass(scan, other))
            return fail_open(scan, "a comment or a declaration");
    }
}

bool xml_root_is(const starg_source *source, const char *name) {
    xml_scan scan = xml_scan_make(source);
    for (;;) {
        while (scan.at < scan.end && is_blank(*scan.at))
            scan.at++;
        const char *other = end_of_other(&scan);
        if (other == NULL)
            break;
        if (!pass(&scan, other))
            return false;
    }
    if (!begins(&scan, "<"))
        return false;
    scan.at++;
    size_t length = strlen(name);
    return begins(&scan, name) && (size_t)(scan.end - scan.at) > length &&
           (is_blank(scan.at[length]) || scan.at[length] == '>');
}

bool xml_attribute(const xml_tag *tag, const char *name, starg_word *value) {
    const char *at = tag->attributes.text, *end = at + tag->attributes.length;
    while (at < end) {
        while (at < end && is_blank(*at))
            at++;
        const char *begin = at;
        while (at < end && !is_blank(*at) && *at != '=')
            at++;
        starg_word found = word_between(begin, at, tag->name.line);
        while (at < end && (is_blank(*at) || *at == '='))
            at++;
        if (at == end || (*at != '"' && *at != '\''))
            return false;
        const char *stop = memchr(at + 1, *at, (size_t)(end - at - 1));
        if (stop == NULL)
            return false;
        *value = word_between(at + 1, stop, tag->name.line);
        if (starg_word_is(found, name))
            return true;
        at = stop + 1;
    }
    return false;
}
