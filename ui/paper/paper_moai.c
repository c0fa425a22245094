/* Figures 4 and 5: the Moai in the hands of a performer, anchored and unanchored. Each picture is
 * made by exactly the command that is printed below it, in a separate process. */
#include "paper/paper.h"

#include "base/clock.h"
#include "base/program.h"
#include "base/installed.h"
#include "stage/mapping/plugins.h"

#include <errno.h>
#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Interval of checks; time from the request to end to the end. */
static const int64_t turn_ns = 20 * NS_PER_MS, goodbye_ns = 5 * NS_PER_S;

/* ---- running a command of this program ---- */

enum { WORDS_MAX = 24 };

/* posix_spawn does not write to the words, although its declaration allows it. */
static bool start(pid_t *out, const char *const *word, FILE *told, FILE *trouble)
{
    char program[INSTALLED_LENGTH];
    const program_start how = {.program = program,
                               .words = (char *const *)(uintptr_t)word,
                               .in = -1,
                               .out = fileno(told),
                               .err = fileno(trouble)};
    return installed_program(program) && program_spawn(out, &how) == 0;
}

/* Waits until the process ends, or until the user wants to stop. */
static mrt_result wait_for(paper *of, pid_t pid, int *out_status, error *err)
{
    mrt_result result = MRT_OK;
    while (result >= 0 && waitpid(pid, out_status, WNOHANG) == 0) {
        progress_show(&of->shown, -1.0, "the Moai");
        clock_sleep_until_ns(clock_now_ns() + turn_ns);
        result = paper_check_stop(err);
    }
    if (result < 0) {
        (void)kill(pid, SIGTERM);
        (void)program_wait(pid, out_status, goodbye_ns);
    }
    return result;
}

/* Reads the last line of its messages. */
static void read_reason(char *out, int capacity, FILE *trouble)
{
    out[0] = '\0';
    rewind(trouble);
    while (fgets(out, capacity, trouble))
        out[strcspn(out, "\n")] = '\0';
}

/* told, trouble: files without a name, for its stdout and stderr. */
static mrt_result run_into(paper *of, const char *const *word, FILE *told, FILE *trouble,
                           json_t **out_facts, error *err)
{
    char reason[1024];
    int status = 0;
    pid_t pid = 0;
    if (!told || !trouble || !start(&pid, word, told, trouble))
        return error_set(err, MRT_ERR_IO, "marotte %s cannot be started: %s", word[1],
                         strerror(errno));
    mrt_result result = wait_for(of, pid, &status, err);
    read_reason(reason, sizeof reason, trouble);
    rewind(told);
    if (result >= 0 && !(WIFEXITED(status) && WEXITSTATUS(status) == 0))
        result = error_set(err, MRT_ERR_IO, "a picture of the page: %s", reason);
    if (result >= 0 && !(*out_facts = json_loadf(told, 0, NULL)))
        result = error_set(err, MRT_ERR_FORMAT, "marotte %s --json gave no object", word[1]);
    return result;
}

static mrt_result run_command(paper *of, const char *const *word, json_t **out_facts, error *err)
{
    FILE *told = tmpfile(), *trouble = tmpfile();
    *out_facts = NULL;
    mrt_result result = run_into(of, word, told, trouble, out_facts, err);
    if (told)
        (void)fclose(told);
    if (trouble)
        (void)fclose(trouble);
    return result;
}

/* ---- the pictures ---- */

typedef struct figure {
    const char *file, *heading, *what, *map, *text;
} figure;

static const figure figures[] = {
    {"figure4_anchored.png", "Figure 4: the Moai, anchored",
     "Eight moments of the Moai, held by ten fingertips in the anchored way", "anchored",
     "Ten fingertips take hold of the face where they are, and pull. When they let go, the face "
     "returns to its shape."},
    {"figure5_unanchored.png", "Figure 5: the Moai, unanchored",
     "Eight moments of the Moai, kneaded by ten fingertips in the unanchored way", "unanchored",
     "The same two hands knead the stone as clay: every push stays."},
};

/* Figures with the paper's own settings, where the mapping has them. They show the purpose of our
 * defaults. */
static const figure to_the_letter[] = {
    {"figure4_letter.png", "Figure 4 to the letter of the paper",
     "The Moai in the anchored way with the paper's own settings", "anchored,preset=paper",
     "The same hands with the paper's settings: linear polynomial, gain 1, no soft end of a pull, "
     "nothing held back."},
    {"figure5_letter.png", "Figure 5 to the letter of the paper",
     "The Moai in the unanchored way with the paper's own settings", "unanchored,preset=paper",
     "Likewise, with one step for each sample, however quick the hand."},
};

static double fact_of(const json_t *told, const char *key)
{
    return json_number_value(json_object_get(told, key));
}

/* Facts of perform that the page repeats: the key, and the text around the number. */
static const struct {
    const char *key, *before, *behind;
    int decimals;
} told_facts[] = {
    {"range_of_motion_mm", "moves by up to ", " mm", 1},
    {"folds", "", " folds", 0},
    {"min_determinant", "least determinant ", "", 3},
    {"inside_out", "", " triangles inside out", 0},
    {"bent_edges", "", " edges bent by more than 120 degrees", 0},
    {"stretch", "stretched at most ", " times", 1},
    {"held_back_mm", "held back by at most ", " mm", 1},
};
enum { TOLD_FACTS = sizeof told_facts / sizeof told_facts[0] };

static void add_facts(paper *of, const figure *f, const json_t *told)
{
    char line[512] = "";
    facts_cell cells[TOLD_FACTS + 3] = {{"file", f->file, 0.0, 0},
                                        {"map", f->map, 0.0, 0},
                                        {"frames", NULL, fact_of(told, "frames"), 0}};
    int count = 3;
    for (int i = 0; i < TOLD_FACTS; ++i) {
        if (!json_object_get(told, told_facts[i].key))
            continue;
        size_t used = strlen(line);
        double value = fact_of(told, told_facts[i].key);
        (void)snprintf(line + used, sizeof line - used, "%s%s%.*f%s", used ? ", " : "",
                       told_facts[i].before, told_facts[i].decimals, value, told_facts[i].behind);
        cells[count++] = (facts_cell){told_facts[i].key, NULL, value, 4};
    }
    page_caption(of->page,
                 "%s Eight moments, each the frame furthest from rest in one eighth of %.0f "
                 "frames, from the front and from three quarters. The face %s.",
                 f->text, fact_of(told, "frames"), line);
    facts_row(of->told, "figures", "", "", cells, count);
}

/* Prints the command as a person types it: with the picture in the current folder, and without
 * --json. */
static void add_command(paper *of, const figure *f, const char *const *word)
{
    char line[3 * INSTALLED_LENGTH] = "marotte";
    size_t used = strlen(line);
    for (int i = 1; word[i] && used < sizeof line; ++i) {
        bool is_picture = strcmp(word[i - 1], "--export") == 0;
        char quoted[INSTALLED_LENGTH + 64];
        program_quote(quoted, sizeof quoted, is_picture ? f->file : word[i]);
        used += (size_t)snprintf(line + used, sizeof line - used, " %s", quoted);
    }
    page_command(of->page, line);
}

static mrt_result add_figure(paper *of, const figure *f, error *err)
{
    char path[PATH_MAX];
    json_t *told;
    mrt_result result = paper_add_file(of, path, f->file, err);
    if (result < 0)
        return result;
    const char *word[WORDS_MAX] = {"marotte",  "perform",
                                   "--face",   "moai",
                                   "--input",  "log:demo_hand.csv",
                                   "--input",  "log:demo_left_hand.csv",
                                   "--map",    f->map,
                                   "--export", path};
    int count = 12;
    if (of->is_quick) {
        static const char *const quick[] = {"--seconds", "2", "--size", "480x240"};
        for (int i = 0; i < 4; ++i)
            word[count++] = quick[i];
    }
    const char *run[WORDS_MAX];
    memcpy(run, word, sizeof word);
    run[count] = "--json";
    result = run_command(of, run, &told, err);
    if (result < 0)
        return result;
    page_heading(of->page, f->heading);
    page_picture(of->page, f->file, f->what, 720, 0);
    add_command(of, f, word);
    add_facts(of, f, told);
    json_decref(told);
    return MRT_OK;
}

static bool can_be_paper(const mrt_plugin_type *mapping)
{
    for (uint32_t i = 0; i < mapping->param_count; ++i)
        if (strcmp(mapping->params[i].name, "Preset") == 0)
            return true;
    return false;
}

/* Returns whether both mappings have the preset. */
static bool have_paper_preset(void)
{
    plugin_list plugins = {0};
    const mrt_plugin_type *anchored, *unanchored;
    error ignored;
    bool is_there =
        plugin_list_load(&plugins, &ignored) >= 0 &&
        plugin_list_find(&plugins, "anchored", MRT_MAPPING, &anchored, &ignored) >= 0 &&
        plugin_list_find(&plugins, "unanchored", MRT_MAPPING, &unanchored, &ignored) >= 0 &&
        can_be_paper(anchored) && can_be_paper(unanchored);
    plugin_list_destroy(&plugins);
    return is_there;
}

mrt_result paper_moai(paper *of, error *err)
{
    const size_t letters = of->is_quick || !have_paper_preset() ? 0 : 2;
    mrt_result result = MRT_OK;
    if (!of->drawn_by[0]) {
        page_heading(of->page, "Figures 4 and 5: the Moai");
        page_text(of->page, "No pictures of the Moai: %s", of->no_drawing.text);
        return MRT_OK;
    }
    for (size_t i = 0; i < sizeof figures / sizeof figures[0] && result >= 0; ++i)
        result = add_figure(of, &figures[i], err);
    for (size_t i = 0; i < letters && result >= 0; ++i)
        result = add_figure(of, &to_the_letter[i], err);
    return result;
}
