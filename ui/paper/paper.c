/* marotte paper: compares the paper with the program, on one page. */
#include "paper/paper.h"

#include "base/cancel.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/isa.h"
#include "base/pool.h"
#include "bench/bench.h"
#include "cli/command.h"
#include "draw/draw.h"
#include "stage/mapping/plugins.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static const char html_name[] = "paper.html", markdown_name[] = "paper.md",
                  data_name[] = "paper.json", usual_folder[] = "out/paper";

static const char help[] =
    "marotte paper [--out FOLDER] [--quick] [--json]\n"
    "\n"
    "Writes a page that compares the paper (\"3D Freeform Design: Interactive Shape\n"
    "Deformations by the Use of CyberGlove\") with this program: all cells of Table 1, its "
    "figures\n"
    "drawn again, its claims about the solver, a plain reference solve, its misprints, and every\n"
    "default of marotte that differs, with the reason.\n"
    "\n"
    "  --out FOLDER  where to write paper.html, paper.md (the same as Markdown), paper.json\n"
    "                (the figures) and the pictures (out/paper); replaces an older page\n"
    "  --quick       a few seconds: fewer rounds, small pictures, rougher figures\n"
    "  --json        print the figures as one JSON object\n"
    "\n"
    "It takes a minute or two and needs no display. If it is stopped or fails, an older page\n"
    "is kept.\n";

mrt_result paper_check_stop(error *err)
{
    return cancel_is_requested() ? error_set(err, MRT_ERR_IO, "stopped; nothing was written")
                                 : MRT_OK;
}

void paper_count(char out[32], double value)
{
    char plain[32];
    int length = snprintf(plain, sizeof plain, "%.0f", value), used = 0;
    for (int i = 0; i < length; ++i) {
        if (i > 0 && (length - i) % 3 == 0)
            used += snprintf(out + used, 32 - (size_t)used, "\u202f");
        out[used++] = plain[i];
    }
    out[used] = '\0';
}

/* ---- the folder ---- */

static mrt_result path_in(char out[PATH_MAX], const char *folder, const char *name, error *err)
{
    int length = snprintf(out, PATH_MAX, "%s%s", folder, name);
    if (length > 0 && length < PATH_MAX)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "%.200s...: the path is too long", folder);
}

mrt_result paper_add_file(paper *self, char out_path[PATH_MAX], const char *name, error *err)
{
    if (self->file_count == PAPER_FILES_MAX || strlen(name) >= PAPER_NAME)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: too many files for one page", name);
    (void)snprintf(self->file[self->file_count++], PAPER_NAME, "%s", name);
    return path_in(out_path, self->meanwhile, name, err);
}

/* Uses a folder that is not empty only if it contains a page of marotte. */
static mrt_result check_entries(const char *folder, error *err)
{
    char path[PATH_MAX];
    mrt_result result = path_in(path, folder, data_name, err);
    if (result < 0 || access(path, F_OK) == 0)
        return result;
    DIR *opened = opendir(folder);
    if (!opened)
        return error_set(err, MRT_ERR_IO, "%s: %s", folder, strerror(errno));
    const struct dirent *entry;
    while (result >= 0 && (entry = readdir(opened)))
        if (entry->d_name[0] != '.')
            result =
                error_set(err, MRT_ERR_IO,
                          "%s: contains %s and no page of marotte. Name an empty or a new folder",
                          folder, entry->d_name);
    closedir(opened);
    return result;
}

static mrt_result make_folder(paper *self, const char *given, error *err)
{
    const char *folder = given ? given : usual_folder;
    size_t length = strlen(folder);
    if (length == 0 || length > PATH_MAX - 2 * PAPER_NAME)
        return error_set(err, MRT_ERR_ARGUMENT, "--out: %s",
                         length ? "the path is too long" : "a folder is expected");
    (void)snprintf(self->folder, sizeof self->folder, "%s%s", folder,
                   folder[length - 1] == '/' ? "" : "/");
    mrt_result made = file_make_parent(self->folder, err);
    if (made < 0)
        return made;
    self->was_made = mkdir(self->folder, 0777) == 0;
    struct stat status;
    if (!self->was_made && errno != EEXIST)
        return error_set(err, MRT_ERR_IO, "%s: cannot create this folder: %s", folder,
                         strerror(errno));
    if (stat(self->folder, &status) != 0 || !S_ISDIR(status.st_mode))
        return error_set(err, MRT_ERR_IO, "%s: not a folder", folder);
    mrt_result result = self->was_made ? MRT_OK : check_entries(self->folder, err);
    char meanwhile[PATH_MAX];
    if (result >= 0)
        result = path_in(meanwhile, self->folder, ".unfinished.XXXXXX", err);
    if (result < 0)
        return result;
    if (!mkdtemp(meanwhile))
        return error_set(err, MRT_ERR_IO, "%s: cannot write into it: %s", folder, strerror(errno));
    return path_in(self->meanwhile, meanwhile, "/", err);
}

/* Moves the pictures first, and the page that names them last. */
static mrt_result move_files(paper *self, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < self->file_count && result >= 0; ++i) {
        char from[PATH_MAX], to[PATH_MAX];
        result = path_in(from, self->meanwhile, self->file[i], err);
        if (result >= 0)
            result = path_in(to, self->folder, self->file[i], err);
        if (result >= 0 && rename(from, to) != 0)
            result = error_set(err, MRT_ERR_IO, "%s: cannot write: %s", to, strerror(errno));
        self->was_made = self->was_made && result < 0;
    }
    return result;
}

/* Removes unfinished files, and the folder if it was created for them. */
static void remove_unfinished(paper *self)
{
    for (uint32_t i = 0; self->meanwhile[0] && i < self->file_count; ++i) {
        char path[PATH_MAX];
        error ignored;
        if (path_in(path, self->meanwhile, self->file[i], &ignored) >= 0)
            (void)unlink(path);
    }
    if (self->meanwhile[0])
        (void)rmdir(self->meanwhile);
    if (self->was_made)
        (void)rmdir(self->folder);
}

/* ---- texts: the misprints of the paper, and each default of ours that differs ---- */

typedef struct misprint {
    const char *printed, *meant, *how;
} misprint;

static const misprint misprints[] = {
    {"Table 1, 32 768 polygons, R = 60: 115 812 pairs", "155 812",
     "9.34 and 9.37 pairs a vertex are above and below it in the same column. 115 812 would be "
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
    page_heading(of->page, "Misprints of the paper");
    page_table(of->page, head, 3);
    for (size_t i = 0; i < sizeof misprints / sizeof misprints[0]; ++i) {
        const char *const cell[] = {misprints[i].printed, misprints[i].meant, misprints[i].how};
        page_row(of->page, cell);
    }
    page_table_end(of->page);
}

/* If a mapping is named, `here` is replaced by the value of its parameter. */
typedef struct departure {
    const char *what, *mapping, *group, *name; /* mapping NULL: use `here` */
    const char *here, *paper, *reason;
} departure;

static const departure departures[] = {
    {"Kernel", NULL, NULL, NULL, "Wendland C2",
     "a compactly supported function of its reference [11]; which one is not in our notes",
     "twice differentiable, and the cheapest such kernel; C0, C4 and C6 can be chosen"},
    {"Polynomial", NULL, NULL, NULL, "none", "linear, over all of space (equations 1 to 3)",
     "with it the back of the head moves 4 to 10 times further than the fingers"},
    {"Radius, anchored", "anchored", "Pull", "Radius", NULL, "a length, the same for every model",
     "a share of the face feels the same on a doll and on a statue"},
    {"Radius, unanchored", "unanchored", "Pull", "Radius", NULL,
     "a length, the same for every model", "likewise"},
    {"Gain, anchored", "anchored", "Pull", "Gain", NULL, "1",
     "a talking hand moves further than a face should"},
    {"Gain, unanchored", "unanchored", "Pull", "Gain", NULL, "1",
     "clay keeps every push, so each one counts for less"},
    {"Soft end of a pull", "anchored", "Pull", "Reach", NULL, "none",
     "one fingertip that pulls further than 64/135 R folds the surface"},
    {"Stretch of an edge, at most", "anchored", "Solver", "Stretch", NULL, "no limit",
     "near the limit the pull is reduced: skin that is pulled further looks torn, or folds"},
    {"Steps of an unanchored sample", NULL, NULL, NULL, "as many as prevent folds, up to 32",
     "one a frame", "one step of a quick hand turns the surface inside out"},
    {"“Within radius?”, anchored", NULL, NULL, NULL, "tested once, for the starts",
     "tested for the end points",
     "otherwise the face would freeze when a finger pulls further than the radius"},
    {"Unit of time", NULL, NULL, NULL, "a sample of the gloves", "a drawn frame",
     "a performance must not depend on the drawing speed"},
    {"An anchored frame", NULL, NULL, NULL, "sums responses computed at engage",
     "evaluates its field again", "the same result, several times as fast at any radius"},
    {"Order of centres", NULL, NULL, NULL, "Morton curve up to 64, then the longest axis", "octree",
     "the envelope is smaller, and the result has the same bits for any numbering"},
    {"Factorisation", NULL, NULL, NULL, "Cholesky within the envelope", "of a band",
     "sorting along an octree narrows the envelope, but hardly the band"},
    {"Centres at one place", NULL, NULL, NULL, "merged below R / 1000", "not in our notes",
     "two fingertips that meet must not tear the face"},
    {"Angles", NULL, NULL, NULL, "smoothed by a One-Euro filter; cameras have their own",
     "not in our notes", "the noise of a glove is visible on a face that holds still"},
    {"Where the hand is laid", "anchored", "Placement", "Posture", NULL, "not in our notes",
     "a hand without a tracker needs a place; the performer can change it"},
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

/* Returns false if the mapping has no such parameter. */
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
    page_heading(of->page, "Defaults that depart from the paper");
    page_table(of->page, head, 4);
    for (size_t i = 0; i < sizeof departures / sizeof departures[0]; ++i) {
        char here[64];
        const char *const cell[] = {departures[i].what, here, departures[i].paper,
                                    departures[i].reason};
        if (write_default(here, plugins, &departures[i]))
            page_row(of->page, cell);
    }
    page_table_end(of->page);
}

static mrt_result paper_words(paper *of, error *err)
{
    plugin_list plugins = {0};
    mrt_result result = plugin_list_load(&plugins, err);
    add_misprints(of);
    if (result >= 0)
        add_departures(of, &plugins);
    plugin_list_destroy(&plugins);
    return result;
}

/* ---- the page ---- */

static void find_drawer(paper *self)
{
    draw_context *context = draw_context_create(&self->no_drawing);
    const char *name = context ? draw_context_driver(context) : "";
    bool is_software = strstr(name, "llvmpipe") || strstr(name, "softpipe") ||
                       strstr(name, "SWR") || strstr(name, "swrast");
    if (context)
        (void)snprintf(self->drawn_by, sizeof self->drawn_by, "%s (%s)",
                       is_software ? "software" : "GPU", name);
    else
        fprintf(stderr, "note: the page has no pictures of faces: %s\n", self->no_drawing.text);
    draw_context_destroy(context);
}

static void introduce(paper *self)
{
    char processor[128], date[64];
    time_t now = time(NULL);
    struct tm when;
    bench_processor(processor, sizeof processor);
    if (!gmtime_r(&now, &when) || strftime(date, sizeof date, "%Y-%m-%d", &when) == 0)
        date[0] = '\0';
    page_text(
        self->page,
        "“3D Freeform Design: Interactive Shape Deformations by the Use of CyberGlove” lets a "
        "performer in two gloves take hold of a face with ten fingertips. Compactly supported "
        "radial basis functions carry the motion of the fingertips to the surface, in an "
        "anchored and an unanchored way. This page compares its tables and figures with "
        "`marotte`, measured and drawn on one machine in one run of `marotte paper`.");
    page_text(self->page,
              "marotte %s, %s. Processor: %s, one thread, instruction set %s. Pictures: %s. A "
              "missing number of the paper is not in our notes of it. The paper's times are "
              "from a computer of its day, with its display: compare the shape of the table, "
              "not the speed.%s",
              MAROTTE_VERSION, date, processor, isa_name(isa_now()),
              self->drawn_by[0] ? self->drawn_by : "none, because drawing is not possible here",
              self->is_quick ? " This page was made with --quick: its times are rough." : "");
    facts_text(self->told, "version", "version", MAROTTE_VERSION);
    facts_text(self->told, "date", "date", date);
    facts_text(self->told, "processor", "processor", processor);
    facts_text(self->told, "instruction_set", "instructions", isa_name(isa_now()));
    facts_text(self->told, "drawn_by", "drawn by", self->drawn_by);
}

static mrt_result fill_page(paper *self, error *err)
{
    static const struct {
        const char *name;
        mrt_result (*run)(paper *self, error *err);
    } sections[] = {
        {"hands", paper_hands},    {"Table 1", paper_table},
        {"the Moai", paper_moai},  {"solving equations", paper_solver},
        {"defaults", paper_words},
    };
    enum { SECTIONS = sizeof sections / sizeof sections[0] };
    find_drawer(self);
    introduce(self);
    mrt_result result = MRT_OK;
    for (int i = 0; i < SECTIONS && result >= 0; ++i) {
        progress_show(&self->shown, (double)i / SECTIONS, sections[i].name);
        result = sections[i].run(self, err);
        if (result >= 0)
            result = paper_check_stop(err);
    }
    return result;
}

static mrt_result write_page(paper *self, error *err)
{
    char html[PATH_MAX], markdown[PATH_MAX], data[PATH_MAX];
    mrt_result result = paper_add_file(self, markdown, markdown_name, err);
    if (result >= 0)
        result = paper_add_file(self, data, data_name, err);
    if (result >= 0)
        result = paper_add_file(self, html, html_name, err);
    if (result >= 0)
        result = page_write(self->page, html, markdown, err);
    if (result >= 0)
        result = facts_save(self->told, data, err);
    return result < 0 ? result : move_files(self, err);
}

static mrt_result make(paper *self, const char *folder, error *err)
{
    mrt_result result = make_folder(self, folder, err);
    self->page = page_create("The paper beside the program");
    self->told = facts_create(FACTS_JSON);
    if (result >= 0 && (!self->page || !self->told))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a page");
    if (result < 0)
        return result;
    pool_share_from((double)INFINITY); /* one thread: the amount of work is compared */
    int64_t start_ns = clock_now_ns();
    progress_start(&self->shown, "writing the page");
    result = fill_page(self, err);
    if (result >= 0) {
        facts_number(self->told, "took_s", "took", (double)(clock_now_ns() - start_ns) * 1e-9, 1,
                     "s");
        result = write_page(self, err);
    }
    progress_end(&self->shown);
    return result;
}

static void print_summary(const paper *self)
{
    for (uint32_t i = 0; i < self->file_count; ++i)
        printf("%-18s %s%s\n", "wrote", self->folder, self->file[i]);
    printf("%-18s %.2f %% at most\n", "pairs, off Table 1", 100.0 * self->worst_pairs_off);
    printf("%-18s %s\n", "pictures", self->drawn_by[0] ? self->drawn_by : "none");
}

typedef struct paper_options {
    bool is_quick, is_json;
    const char *folder; /* NULL: out/paper */
} paper_options;

#define AT(member) .offset = offsetof(paper_options, member)
static const command_option option_table[] = {
    {"out", COMMAND_TEXT, AT(folder)},
    {"quick", COMMAND_FLAG, AT(is_quick)},
    {"json", COMMAND_FLAG, AT(is_json)},
    {.name = NULL},
};

static int run(int argc, char **argv)
{
    paper_options options = {.folder = NULL};
    error err = {""};
    int code = command_options(&options, &command_paper, option_table, argc, argv);
    if (code != COMMAND_DONE)
        return code;
    paper self = {.is_quick = options.is_quick};
    cancel_on_signals(CANCEL_WAITS, NULL);
    mrt_result result = make(&self, options.folder, &err);
    remove_unfinished(&self);
    page_destroy(self.page);
    if (result >= 0 && options.is_json)
        return command_end(&command_paper, self.told, result, &err);
    facts_abandon(self.told);
    if (result < 0)
        return command_failed(&command_paper, &err);
    print_summary(&self);
    return COMMAND_DONE;
}

const command command_paper = {
    .name = "paper",
    .summary = "compare the paper with this program, on a page",
    .help = help,
    .examples = "paper --quick\n"
                "paper --quick --out out/mine\n",
    .run = run,
    .options = option_table,
};
