/* SPDX-License-Identifier: Apache-2.0 */
/* Letters as polylines on a small lattice, drawn as round strokes: a pixel takes as much ink as the
 * nearest stroke covers of it, so that any size and direction is smooth.
 *
 * Cost: O(pixels of a character's box x its segments). */
#include "export/export.h"

#include <math.h>
#include <string.h>

/* Lattice: capitals are 4 wide and 6 high, the line below them at 6, tails to 8; columns are
 * SLIMNESS as wide as rows are high, and a character takes ADVANCE of them. */
enum { CAPITAL = 6, BOTTOM = 9, FIRST = '!', LAST = '~' };
static const double ADVANCE = 5.8, SLIMNESS = 0.82, STROKE = 0.42;

/* Strokes are parted by spaces; each is a list of points, a digit for x and one for y. */
static const char BOX[] = "0040460600";
static const char *const GLYPHS[LAST - FIRST + 1] = {
    "2024 26",                          /* ! */
    "1012 3032",                        /* " */
    "1016 3036 0242 0444",              /* # */
    "413010010213334445361605 2026",    /* $ */
    "4006 1001122110 3425364534",       /* % */
    "4612112031320405162644",           /* & */
    "2022",                             /* ' */
    "30212536",                         /* ( */
    "10212516",                         /* ) */
    "2125 0244 0442",                   /* * */
    "2125 0343",                        /* + */
    "2617",                             /* , */
    "1333",                             /* - */
    "26",                               /* . */
    "4006",                             /* / */
    "103041453616050110 1432",          /* 0 */
    "112026 1636",                      /* 1 */
    "01103041420646",                   /* 2 */
    "01103041423313 334445361605",      /* 3 */
    "36300444",                         /* 4 */
    "400002324345361605",               /* 5 */
    "413010010516364544331304",         /* 6 */
    "004016",                           /* 7 */
    "13020110304142331304051636454433", /* 8 */
    "051636454130100102133342",         /* 9 */
    "22 26",                            /* : */
    "22 2617",                          /* ; */
    "410345",                           /* < */
    "0242 0444",                        /* = */
    "014305",                           /* > */
    "01103041422324 26",                /* ? */
    "46160501103041443432221324 2434",  /* @ */
    "0602204246 0444",                  /* A */
    "00063645443303 0030414233",        /* B */
    "4130100105163645",                 /* C */
    "00063645413000",                   /* D */
    "40000646 0333",                    /* E */
    "400006 0333",                      /* F */
    "41301001051636454323",             /* G */
    "0006 4046 0343",                   /* H */
    "1030 2026 1636",                   /* I */
    "4045361605",                       /* J */
    "0006 400346",                      /* K */
    "000646",                           /* L */
    "0600234046",                       /* M */
    "06004640",                         /* N */
    "103041453616050110",               /* O */
    "06003041423303",                   /* P */
    "103041453616050110 2446",          /* Q */
    "06003041423303 2346",              /* R */
    "413010010213334445361605",         /* S */
    "0040 2026",                        /* T */
    "000516364540",                     /* U */
    "002640",                           /* V */
    "0016233640",                       /* W */
    "0046 4006",                        /* X */
    "002340 2326",                      /* Y */
    "00400646",                         /* Z */
    "30101636",                         /* [ */
    "0046",                             /* \ */
    "10303616",                         /* ] */
    "022042",                           /* ^ */
    "0747",                             /* _ */
    "1021",                             /* ` */
    "4246 4332120305163645",            /* a */
    "0006 0312324345361605",            /* b */
    "4332120305163645",                 /* c */
    "4046 4332120305163645",            /* d */
    "04444332120305163645",             /* e */
    "40302126 1242",                    /* f */
    "4247381807 4332120305163645",      /* g */
    "0006 0312324346",                  /* h */
    "20 122226 1636",                   /* i */
    "30 1232372818",                    /* j */
    "0006 420446",                      /* k */
    "102026 1636",                      /* l */
    "0602 03122326 23324346",           /* m */
    "0602 0312324346",                  /* n */
    "123243453616050312",               /* o */
    "0208 0312324345361605",            /* p */
    "4248 4332120305163645",            /* q */
    "1612 13223243",                    /* r */
    "43321203143445361605",             /* s */
    "20253646 1242",                    /* t */
    "0205163645 4246",                  /* u */
    "022642",                           /* v */
    "0216243642",                       /* w */
    "0246 4206",                        /* x */
    "0226 4218",                        /* y */
    "02420646",                         /* z */
    "30212213242536",                   /* { */
    "2027",                             /* | */
    "10212233242516",                   /* } */
    "04133443",                         /* ~ */
};

/* The characters of a text, without the later bytes of a character of UTF-8. */
static bool begins(char c) {
    return ((unsigned char)c & 0xC0) != 0x80;
}

static const char *glyph_of(char c) {
    if (c == ' ')
        return "";
    return c >= FIRST && c <= LAST ? GLYPHS[c - FIRST] : BOX;
}

static double square_to_segment(const double p[2], const double a[2], const double b[2]) {
    double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
    double x = p[0] - a[0], y = p[1] - a[1];
    double t = square > 0 ? (x * dx + y * dy) / square : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return (x - t * dx) * (x - t * dx) + (y - t * dy) * (y - t * dy);
}

/* Distance, in lattice units, of a point to the strokes of a glyph. */
static double distance(const char *glyph, const double p[2]) {
    double least = INFINITY, from[2] = {0, 0};
    bool down = false;
    for (const char *c = glyph; *c != '\0'; c++) {
        if (*c == ' ') {
            down = false;
            continue;
        }
        double to[2] = {SLIMNESS * (c[0] - '0'), c[1] - '0'};
        c++;
        least = fmin(least, square_to_segment(p, down ? from : to, to));
        memcpy(from, to, sizeof from);
        down = true;
    }
    return sqrt(least);
}

static void blend(uint8_t rgb[3], const uint8_t ink[3], double cover) {
    for (int k = 0; k < 3; k++)
        rgb[k] = (uint8_t)(rgb[k] + cover * (ink[k] - rgb[k]) + 0.5);
}

/* A character whose capital's middle begins at (x, y); `rim` pixels are added to the strokes. */
static void draw_glyph(const starg_canvas *canvas, const starg_lettering *style, const char *glyph,
                       double x, double y, double rim, const uint8_t ink[3]) {
    double unit = style->height / CAPITAL, radius = STROKE * unit + rim;
    double reach = BOTTOM * unit + rim + 1;
    long x0 = lround(fmax(0, x - reach)), x1 = lround(fmin((double)canvas->width, x + reach));
    long y0 = lround(fmax(0, y - reach)), y1 = lround(fmin((double)canvas->height, y + reach));
    for (long row = y0; row < y1; row++)
        for (long column = x0; column < x1; column++) {
            double right = (double)column + 0.5 - x, below = (double)row + 0.5 - y;
            double p[2] = {(style->rising ? -below : right) / unit,
                           (style->rising ? right : below) / unit + 0.5 * CAPITAL};
            double cover = radius + 0.5 - unit * distance(glyph, p);
            if (cover > 0)
                blend(canvas->rgb + 3 * ((size_t)row * canvas->width + (size_t)column), ink,
                      fmin(cover, 1));
        }
}

static void draw_line(const starg_canvas *canvas, const starg_lettering *style, const char *text,
                      double x, double y, double rim, const uint8_t ink[3]) {
    double advance = ADVANCE * SLIMNESS * style->height / CAPITAL;
    for (const char *c = text; *c != '\0'; c++) {
        if (!begins(*c))
            continue;
        draw_glyph(canvas, style, glyph_of(*c), x, y, rim, ink);
        *(style->rising ? &y : &x) += style->rising ? -advance : advance;
    }
}

double starg_lettering_length(const starg_lettering *style, const char *text) {
    size_t count = 0;
    for (const char *c = text; *c != '\0'; c++)
        count += begins(*c);
    return (double)count * ADVANCE * SLIMNESS * style->height / CAPITAL;
}

void starg_lettering_draw(const starg_canvas *canvas, const starg_lettering *style,
                          const char *text, double x, double y) {
    static const uint8_t white[3] = {255, 255, 255};
    if (style->halo > 0)
        draw_line(canvas, style, text, x, y, style->halo, white);
    draw_line(canvas, style, text, x, y, 0, style->ink);
}
