/* Made and destroyed: once, a hundred times, and what is left of it. */
#include "check/child/actor.h"
#include "check/child/cases.h"
#include "check/child/stream.h"
#include "check/child/tell.h"
#include "check/child/trap.h"
#include "check/child/watch.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>

enum { WARM_UPS = 10, ROUNDS = 100, SMOKE_FRAMES = 300 };

/* ---- what the process holds ---- */

typedef struct holdings {
    size_t heap_bytes;
    int files, threads, maps;
} holdings;

static int count_entries(const char *folder)
{
    int count = 0;
    DIR *open_folder = opendir(folder);
    while (open_folder && readdir(open_folder))
        count += 1;
    if (open_folder)
        (void)closedir(open_folder);
    return count;
}

static int count_maps(void)
{
    int count = 0, letter;
    FILE *maps = fopen("/proc/self/maps", "r");
    while (maps && (letter = getc(maps)) != EOF)
        count += letter == '\n';
    if (maps)
        (void)fclose(maps);
    return count;
}

static holdings hold_now(void)
{
    holdings out = {.files = count_entries("/proc/self/fd"),
                    .threads = count_entries("/proc/self/task"),
                    .maps = count_maps()};
    out.heap_bytes = trap_heap_bytes();
    return out;
}

static void judge_growth(check_rule rule, const char *what, const holdings *before)
{
    holdings now = hold_now();
    long heap = (long)now.heap_bytes - (long)before->heap_bytes;
    if (heap >= 8 * ROUNDS)
        tell_failed(rule, "after %d times %s %ld bytes more are in use: %ld each time", ROUNDS,
                    what, heap, heap / ROUNDS);
    else if (now.files - before->files >= ROUNDS / 2)
        tell_failed(rule, "after %d times %s %d more files are open", ROUNDS, what,
                    now.files - before->files);
    else if (now.threads - before->threads >= ROUNDS / 2)
        tell_failed(rule, "after %d times %s %d more threads run", ROUNDS, what,
                    now.threads - before->threads);
    else if (now.maps - before->maps >= ROUNDS / 2)
        tell_failed(rule, "after %d times %s %d more mappings of memory are there", ROUNDS, what,
                    now.maps - before->maps);
    tell_ok(rule, "%d times", ROUNDS);
}

/* ---- the cases ---- */

static mrt_plugin *create(const examination *e, host *with)
{
    char words[300];
    host_init(with, HOST_REAL, 0);
    tell_doing(RULE_COUNT, "create()");
    watch_next();
    mrt_plugin *self = e->type->create(&with->plugin);
    if (!self)
        tell_failed(RULE_LIFE_CREATE, "create() returned NULL%s",
                    host_words(with, words)[0] ? words : ", and logged no error");
    return self;
}

static void perform_a_little(const examination *e)
{
    static actor mapping;
    static stream hands;
    char words[300];
    bool is_refused;
    tell_doing(RULE_COUNT, "activate() on %s", faces_name(FACE_USUAL));
    if (!actor_open(&mapping, e->type, faces_of(FACE_USUAL), &is_refused)) {
        if (is_refused)
            tell_failed(RULE_MAPPING_ACTIVATE, "it refuses a face with the usual names%s",
                        host_words(&mapping.host, words));
        return;
    }
    tell_ok(RULE_MAPPING_ACTIVATE, "%s", "");
    tell_doing(RULE_COUNT, "%s", stream_name(STREAM_WALK));
    bool has_hands = stream_begin(&hands, STREAM_WALK, e->seed, e->type);
    for (int i = 0; i < SMOKE_FRAMES && has_hands; ++i) {
        stream_next(&hands, &mapping.frame);
        actor_step(&mapping);
    }
    tell_doing(RULE_COUNT, "deactivate() and destroy()");
    actor_close(&mapping);
}

void cases_smoke(const examination *e)
{
    host with;
    uint64_t before = types_sum(e->type);
    mrt_plugin *self = create(e, &with);
    if (!self)
        return;
    tell_ok(RULE_LIFE_CREATE, "%s", "");
    tell_doing(RULE_COUNT, "destroy()");
    watch_next();
    e->type->destroy(self);
    if (types_interface(e->type, MRT_MAPPING))
        perform_a_little(e);
    if (types_sum(e->type) != before)
        tell_failed(RULE_TYPE_CONST, "its tables are not what they were before it ran");
    tell_ok(RULE_TYPE_CONST, "%s", "");
    tell_ok(RULE_RUN_CRASH, "%s", "");
    tell_ok(RULE_RUN_HANG, "%s", "");
    tell_ok(RULE_RUN_EXIT, "%s", "");
    tell_ok(RULE_RUN_EXPLAINED, "%s", "");
}

void cases_destroy_null(const examination *e)
{
    tell_doing(RULE_LIFE_DESTROY_NULL, "destroy(NULL)");
    e->type->destroy(NULL);
    tell_ok(RULE_LIFE_DESTROY_NULL, "%s", "");
}

void cases_life(const examination *e)
{
    host with;
    holdings before = {0};
    for (int i = 0; i < WARM_UPS + ROUNDS; ++i) {
        mrt_plugin *self = create(e, &with);
        if (!self)
            return;
        tell_doing(RULE_COUNT, "destroy()");
        watch_next();
        e->type->destroy(self);
        if (i == WARM_UPS - 1)
            before = hold_now();
    }
    judge_growth(RULE_LIFE_GROWTH, "create() and destroy()", &before);
}

void cases_growth(const examination *e)
{
    static actor mapping;
    bool is_refused;
    holdings before = {0};
    tell_doing(RULE_COUNT, "activate() on %s", faces_name(FACE_USUAL));
    if (!actor_open(&mapping, e->type, faces_of(FACE_USUAL), &is_refused))
        return;
    for (int i = 0; i < WARM_UPS + ROUNDS; ++i) {
        tell_doing(RULE_COUNT, "deactivate() and activate()");
        if (!actor_move(&mapping, faces_of(FACE_USUAL), &is_refused))
            return;
        if (i == WARM_UPS - 1)
            before = hold_now();
    }
    judge_growth(RULE_MAPPING_GROWTH, "activate() and deactivate()", &before);
    actor_close(&mapping);
}
