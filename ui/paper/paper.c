/* marotte paper: the paper beside the program, on one page. */
#include "paper/paper.h"

#include "base/cancel.h"
#include "base/clock.h"
#include "base/isa.h"
#include "base/pool.h"
#include "bench/bench.h"
#include "command.h"
#include "draw/draw.h"

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
    "marotte paper [--out FOLDER] [--quick] [--json]\n\n"
    "Writes one page that lays the paper (\"3D Freeform Design: Interactive Shape Deformations by\n"
    "the Use of CyberGlove\") beside this program, measured and drawn here and now: Table 1 in "
    "all\n"
    "its cells, its figures made anew, what the solver is said to do, a plain reference solve,\n"
    "the paper's misprints, and every default that departs from it, with the reason.\n\n"
    "  --out FOLDER  where paper.html, paper.md (the same as Markdown), paper.json (the figures)\n"
    "                and the pictures go (out/paper); a page that marotte wrote there is replaced\n"
    "  --quick       in a few seconds: fewer rounds, small pictures; figures are rougher\n"
    "  --json        the figures as one object, for machines\n\n"
    "It takes a minute or two, and needs no display. On Ctrl-C, or when anything fails, what was\n"
    "there before is still there.\n";

mrt_result paper_check_stop(error *err)
{
    return cancel_is_asked() ? error_set(err, MRT_ERR_IO, "stopped: nothing is written") : MRT_OK;
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

/* A folder that has something in it is only used when a page of ours is part of that. */
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
            result = error_set(err, MRT_ERR_IO,
                               "%s: has %s in it and no page that marotte wrote there: name a "
                               "folder that is empty or not there yet",
                               folder, entry->d_name);
    closedir(opened);
    return result;
}

static mrt_result make_folder(paper *self, const char *given, error *err)
{
    if (!given && mkdir("out", 0777) != 0 && errno != EEXIST)
        return error_set(err, MRT_ERR_IO, "out: cannot be made: %s", strerror(errno));
    const char *folder = given ? given : usual_folder;
    size_t length = strlen(folder);
    if (length == 0 || length > PATH_MAX - 2 * PAPER_NAME)
        return error_set(err, MRT_ERR_ARGUMENT, "--out: %s",
                         length ? "the path is too long" : "a folder is expected");
    (void)snprintf(self->folder, sizeof self->folder, "%s%s", folder,
                   folder[length - 1] == '/' ? "" : "/");
    self->was_made = mkdir(self->folder, 0777) == 0;
    struct stat status;
    if (!self->was_made && errno != EEXIST)
        return error_set(err, MRT_ERR_IO, "%s: the folder cannot be made: %s", folder,
                         strerror(errno));
    if (stat(self->folder, &status) != 0 || !S_ISDIR(status.st_mode))
        return error_set(err, MRT_ERR_IO, "%s: is no folder", folder);
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

/* Pictures first, the page that names them last. */
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

/* What is not finished goes, and the folder if it was made for it. */
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
        "performer in two gloves take hold of a face with ten fingertips: compactly supported "
        "radial basis functions carry what the fingertips do to the surface, in an anchored "
        "and an unanchored way. This page holds its tables and figures beside what `marotte` "
        "does, measured and drawn on one machine in one run by `marotte paper`.");
    page_text(self->page,
              "marotte %s, %s. Processor: %s, one thread, instruction set %s. Pictures: %s. Where "
              "a number of the paper is missing, it is not in our notes of it, and nothing stands "
              "in its place. The paper's times are of a computer of its day, its display included: "
              "they are here for the shape of the table, not as a race.%s",
              MAROTTE_VERSION, date, processor, isa_name(isa_now()),
              self->drawn_by[0] ? self->drawn_by : "none could be drawn here",
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
    self->told = facts_create(true);
    if (result >= 0 && (!self->page || !self->told))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a page");
    if (result < 0)
        return result;
    pool_share_from((double)INFINITY); /* one thread: what is compared is the work */
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

static void tell(const paper *self)
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
    tell(&self);
    return COMMAND_DONE;
}

const command command_paper = {.name = "paper",
                               .summary =
                                   "lays the paper's tables and figures beside its own, on a page",
                               .help = help,
                               .run = run};
