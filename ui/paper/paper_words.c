/* What can only be said: the paper's misprints, and each default of ours that is otherwise. */
#include "paper/paper.h"

#include "stage/mapping/plugins.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- misprints ---- */

typedef struct misprint {
    const char *printed, *meant, *how;
} misprint;

static const misprint misprints[] = {
    {"Table 1, 32 768 polygons, R = 60: 115 812 pairs", "155 812",
     "9.34 and 9.37 pairs a vertex stand above and below it in the same column; 115 812 would be "
     "6.96, 155 812 is 9.36. Our own points give 156 670."},
    {"“65 536 polygons ... 28 frames a second at R = 80”", "13.4, or 32 768 polygons",
     "Table 1 has 13.4 for 65 536 polygons; 28.0 is its row of 32 768."},
    {"“15k vertices”", "33 025 vertices, or 16 641",
     "No model of Table 1 has 15 000 vertices. 65 536 polygons are 33 025 vertices, 32 768 are "
     "16 641."},
    {"“2038 to 65536 vertices”", "2 048 to 65 536 polygons",
     "32 × 32 quads are 2 048 triangles on 1 089 vertices; the largest model is 128 × 128 quads "
     "with a vertex in the middle of each: 65 536 triangles on 33 025 vertices."},
};

static void add_misprints(paper *of)
{
    static const char *const head[] = {"printed", "meant", "how we know"};
    static const page_column column[] = {PAGE_WORDS, PAGE_WORDS, PAGE_WORDS};
    page_heading(of->page, "Misprints of the paper");
    page_table(of->page, head, column, 3);
    for (size_t i = 0; i < sizeof misprints / sizeof misprints[0]; ++i) {
        const char *const cell[] = {misprints[i].printed, misprints[i].meant, misprints[i].how};
        page_row(of->page, cell);
    }
    page_table_end(of->page);
}

/* ---- departures ---- */

/* Where a parameter of a mapping is meant, what stands here is read from the mapping itself. */
typedef struct departure {
    const char *what, *mapping, *group, *name; /* mapping NULL: `here` says it */
    const char *here, *paper, *reason;
} departure;

static const departure departures[] = {
    {"Kernel", NULL, NULL, NULL, "Wendland C2",
     "a compactly supported function of its reference [11]; which one is not in our notes",
     "twice smooth and the cheapest that is; C0, C4 and C6 can be chosen"},
    {"Polynomial", NULL, NULL, NULL, "none", "linear, over all of space (equations 1 to 3)",
     "with it the back of the head moves 4 to 10 times further than the fingers"},
    {"Radius, anchored", "anchored", "Pull", "Radius", NULL, "a length, the same for every model",
     "a share of the face feels alike on a doll and on a statue"},
    {"Radius, unanchored", "unanchored", "Pull", "Radius", NULL,
     "a length, the same for every model", "likewise"},
    {"Gain, anchored", "anchored", "Pull", "Gain", NULL, "1",
     "a hand that talks moves further than a face should"},
    {"Gain, unanchored", "unanchored", "Pull", "Gain", NULL, "1",
     "clay keeps every push, so each counts for less"},
    {"Soft end of a pull", "anchored", "Pull", "Reach", NULL, "none",
     "one fingertip that pulls further than 64/135 R folds the surface"},
    {"Stretch of an edge, at most", "anchored", "Solver", "Stretch", NULL, "no limit",
     "near it less is given: skin that is pulled further looks torn, or folds"},
    {"Steps of an unanchored sample", NULL, NULL, NULL, "as many as keep it from folding, up to 32",
     "one a frame", "one step of a quick hand turns the surface inside out"},
    {"“Within radius?”, anchored", NULL, NULL, NULL, "asked once, of the starts",
     "asked of the end points",
     "else the face would freeze when a finger pulls further than the radius"},
    {"Unit of time", NULL, NULL, NULL, "a sample of the gloves", "a frame that is drawn",
     "a performance must not depend on how fast the picture is drawn"},
    {"An anchored frame", NULL, NULL, NULL, "sums responses computed at engage",
     "evaluates its field anew", "the same result, several times as fast at any radius"},
    {"Order of centres", NULL, NULL, NULL, "Morton curve up to 64, then the longest axis", "octree",
     "the envelope is smaller, and the result has the same bits however they are numbered"},
    {"Factorisation", NULL, NULL, NULL, "Cholesky within the envelope", "of a band",
     "sorting along an octree narrows the envelope, hardly the band"},
    {"Centres at one place", NULL, NULL, NULL, "merged below R / 1000", "not in our notes",
     "two fingertips that meet must not tear the face"},
    {"Angles", NULL, NULL, NULL, "smoothed by a One-Euro filter", "not in our notes",
     "a glove's noise shows on a face that holds still"},
    {"Where the hand is laid", "anchored", "Placement", "Posture", NULL, "not in our notes",
     "a hand without a tracker has to stand somewhere; the placement is the performer's to change"},
    {"Constraints", NULL, NULL, NULL, "bones, regions and a skull, where a face has a rig",
     "none; named as future work", "a jaw that opens needs a hinge, and teeth must not bend"},
};

static const mrt_param *param_of(plugin_list *plugins, const departure *d)
{
    error ignored;
    const mrt_plugin_type *type = NULL;
    if (plugin_list_find(plugins, d->mapping, MRT_MAPPING, &type, &ignored) < 0)
        return NULL;
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (strcmp(type->params[i].group, d->group) == 0 &&
            strcmp(type->params[i].name, d->name) == 0)
            return &type->params[i];
    return NULL;
}

/* False: the mapping has no such parameter. */
static bool write_default(char out[64], plugin_list *plugins, const departure *d)
{
    if (!d->mapping) {
        (void)snprintf(out, 64, "%s", d->here);
        return true;
    }
    const mrt_param *p = param_of(plugins, d);
    if (!p)
        return false;
    if (p->labels)
        (void)snprintf(out, 64, "%s", p->labels[(int)lround(p->initial - p->min)]);
    else
        (void)snprintf(out, 64, "%g%s%s", p->initial, p->unit[0] ? " " : "", p->unit);
    return true;
}

static void add_departures(paper *of, plugin_list *plugins)
{
    static const char *const head[] = {"", "here, by default", "the paper", "why"};
    static const page_column column[] = {PAGE_WORDS, PAGE_WORDS, PAGE_WORDS, PAGE_WORDS};
    page_heading(of->page, "Defaults that depart from the paper");
    page_table(of->page, head, column, 4);
    for (size_t i = 0; i < sizeof departures / sizeof departures[0]; ++i) {
        char here[64];
        const char *const cell[] = {departures[i].what, here, departures[i].paper,
                                    departures[i].reason};
        if (write_default(here, plugins, &departures[i]))
            page_row(of->page, cell);
    }
    page_table_end(of->page);
}

mrt_result paper_words(paper *of, error *err)
{
    plugin_list plugins = {0};
    mrt_result result = plugin_list_load(&plugins, err);
    add_misprints(of);
    if (result >= 0)
        add_departures(of, &plugins);
    plugin_list_destroy(&plugins);
    return result;
}
