/* Cases for all types: creation and destruction. Cases for mappings: running. */
#include "check/child/actor.h"
#include "base/hash.h"
#include "base/percentile.h"
#include "check/child/cases.h"
#include "check/child/tell.h"
#include "check/child/trap.h"
#include "check/wire.h"

#include <dirent.h>
#include <inttypes.h>
#include <malloc.h>
#include <pthread.h>
#include <stdio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- creation and destruction: once and a hundred times, and leaks ---- */

enum { WARM_UPS = 10, ROUNDS = 100, SMOKE_FRAMES = 300 };

/* ---- resources of the process ---- */

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
        tell_failed(rule, "after %d times %s %ld more bytes are in use: %ld each time", ROUNDS,
                    what, heap, heap / ROUNDS);
    else if (now.files - before->files >= ROUNDS / 2)
        tell_failed(rule, "after %d times %s %d more files are open", ROUNDS, what,
                    now.files - before->files);
    else if (now.threads - before->threads >= ROUNDS / 2)
        tell_failed(rule, "after %d times %s %d more threads run", ROUNDS, what,
                    now.threads - before->threads);
    else if (now.maps - before->maps >= ROUNDS / 2)
        tell_failed(rule, "after %d times %s %d more memory mappings exist", ROUNDS, what,
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
                    host_words(with, words)[0] ? words : ", but logged no error");
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
            tell_failed(RULE_MAPPING_ACTIVATE, "it rejects a face with the usual names%s",
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
        tell_failed(RULE_TYPE_CONST, "its tables changed while it ran");
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

/* ---- any face, any hands, a hundred thousand frames, and the time limit ---- */

enum {
    WALK_FRAMES = 25000, /* for each of four processes: 100 000 together */
    FACE_FRAMES = 600,
    HANDS_FRAMES = 3000,
    ENGAGE_FRAMES = 1500,
    ENGAGE_ROUNDS = 8,
    DEADLINE_FRAMES = 4000,
    DEADLINE_PASSES = 3
};
static actor tried, tried_fresh;
static stream tried_hands, tried_fresh_hands;

/* ---- faces ---- */

static bool perform_on(actor *self, stream *with, const examination *e, face_kind kind)
{
    tell_doing(RULE_COUNT, "%s, on %s", stream_name(STREAM_WALK), faces_name(kind));
    if (!stream_begin(with, STREAM_WALK, e->seed + 1, e->type))
        return false;
    play_frames(self, with, FACE_FRAMES);
    return true;
}

/* On the usual face it must behave like an instance that never had another face. */
static void judge_return(const examination *e, face_kind from)
{
    bool is_refused;
    tell_doing(RULE_COUNT, "%s, after %s", stream_name(STREAM_WALK), faces_name(from));
    if (!actor_move(&tried, faces_of(FACE_USUAL), &is_refused)) {
        if (is_refused)
            tell_failed(RULE_MAPPING_FACES, "after %s it rejects the usual face", faces_name(from));
        return;
    }
    actor_reset(&tried_fresh);
    if (stream_begin(&tried_hands, STREAM_WALK, e->seed + 2, e->type) &&
        stream_begin(&tried_fresh_hands, STREAM_WALK, e->seed + 2, e->type))
        (void)play_same(&tried, &tried_hands, &tried_fresh, &tried_fresh_hands, PLAY_SPAN,
                        RULE_MAPPING_FACES, "something of the previous face is left");
}

void cases_faces(const examination *e)
{
    bool is_refused;
    uint32_t refused_count = 0;
    if (!play_open(&tried, &tried_hands, e, STREAM_WALK, e->seed) ||
        !play_open(&tried_fresh, &tried_fresh_hands, e, STREAM_WALK, e->seed))
        return;
    for (int kind = FACE_USUAL; kind < FACE_KINDS; ++kind) {
        tell_doing(RULE_COUNT, "activate() on %s", faces_name((face_kind)kind));
        bool is_taken = actor_move(&tried, faces_of((face_kind)kind), &is_refused);
        if (is_taken && !perform_on(&tried, &tried_hands, e, (face_kind)kind))
            return;
        refused_count += !is_taken;
        judge_return(e, (face_kind)kind);
        if (!tried.face)
            return;
    }
    tell_ok(RULE_MAPPING_FACES, "%d faces, %u rejected", FACE_KINDS, refused_count);
    actor_close(&tried);
    actor_close(&tried_fresh);
}

/* ---- poses of the rig ---- */

/* Poses that a mapping gets in turn: all, none, others, all at another address, and a null
 * pointer. */
typedef struct posed_turn {
    uint32_t count;
    float scale;
    bool is_null;
} posed_turn;
static const posed_turn posed_turns[] = {
    {3, 1.0f, false}, {0, 1.0f, false}, {2, -0.5f, false}, {3, 1.0f, false}, {0, 1.0f, true}};
enum { POSED_TURNS = sizeof posed_turns / sizeof *posed_turns };

/* Opens a new instance that never had other poses. Returns false if it rejects them. */
static bool open_posed(const examination *e, face_poses poses)
{
    bool is_refused;
    tell_doing(RULE_RIG_POSES_SET, "activate() with %u poses", poses.count);
    actor_close(&tried_fresh);
    if (!actor_open_posed(&tried_fresh, e->type, faces_of(FACE_USUAL), poses, &is_refused))
        return false;
    tell_doing(RULE_RIG_POSES_SET, "%s, with %u poses", stream_name(STREAM_RESTLESS), poses.count);
    if (stream_begin(&tried_fresh_hands, STREAM_RESTLESS, e->seed, e->type))
        play_frames(&tried_fresh, &tried_fresh_hands, PLAY_SPAN);
    actor_reset(&tried_fresh);
    return true;
}

/* `before` became invalid, and `now` is valid. */
static void judge_posed_turn(const examination *e, posed_pages *before, face_poses now)
{
    bool is_refused;
    const bool takes = open_posed(e, now);
    tell_doing(RULE_RIG_POSES_VALID, "deactivate()");
    actor_deactivate(&tried);
    if (before->poses.count > 0)
        posed_pages_forbid(before);
    tell_doing(RULE_RIG_POSES_VALID, "%s, with %u poses after %u others",
               stream_name(STREAM_RESTLESS), now.count, before->poses.count);
    if (actor_activate(&tried, faces_of(FACE_USUAL), now, &is_refused) != takes)
        tell_failed(RULE_RIG_POSES_CHANGE,
                    "it %s %u poses after %u others, but a new instance "
                    "does not",
                    takes ? "refuses" : "takes", now.count, before->poses.count);
    else if (takes && stream_begin(&tried_hands, STREAM_RESTLESS, e->seed, e->type) &&
             stream_begin(&tried_fresh_hands, STREAM_RESTLESS, e->seed, e->type))
        (void)play_same(&tried, &tried_hands, &tried_fresh, &tried_fresh_hands, PLAY_SPAN,
                        RULE_RIG_POSES_CHANGE, "something of the previous poses is left");
}

void cases_rig_poses(const examination *e)
{
    posed_pages pages[POSED_TURNS];
    bool is_refused;
    for (int i = 0; i < POSED_TURNS; ++i)
        if (!posed_pages_create(&pages[i], faces_of(FACE_USUAL), posed_turns[i].count,
                                posed_turns[i].scale))
            return;
    tell_doing(RULE_RIG_POSES_SET, "activate() with %u poses", pages[0].poses.count);
    if (!actor_open_posed(&tried, e->type, faces_of(FACE_USUAL), pages[0].poses, &is_refused))
        return;
    tell_doing(RULE_RIG_POSES_SET, "%s", stream_name(STREAM_RESTLESS));
    if (!stream_begin(&tried_hands, STREAM_RESTLESS, e->seed, e->type))
        return;
    play_frames(&tried, &tried_hands, PLAY_SPAN);
    for (int i = 1; i < POSED_TURNS && tried.self; ++i) {
        const face_poses none = {NULL, 0};
        judge_posed_turn(e, &pages[i - 1], posed_turns[i].is_null ? none : pages[i].poses);
    }
    tell_ok(RULE_RIG_POSES_SET, "%s", "");
    tell_ok(RULE_RIG_POSES_VALID, "%s", "");
    tell_ok(RULE_RIG_POSES_CHANGE, "%d times", POSED_TURNS - 1);
    actor_close(&tried);
    actor_close(&tried_fresh);
}

/* ---- hands ---- */

/* frame.deadline reports a mapping that is far too slow, so the walk may end early. */
static const double budget_s = 6.0;

/* A number of rounds, divided as the number of frames is: at least two, of which each has another
 * kind of hands. */
static uint32_t divided(const examination *e, uint32_t rounds)
{
    uint32_t count = rounds / e->divisor;
    return count > 2 ? count : 2;
}

static bool has_time(void)
{
    return (double)clock() / CLOCKS_PER_SEC < budget_s;
}

static void walk(const examination *e, stream_kind kind, uint32_t frames)
{
    if (!play_open(&tried, &tried_hands, e, kind, e->seed))
        return;
    for (uint32_t i = 0; i < frames && has_time(); i += PLAY_SPAN)
        play_frames(&tried, &tried_hands, PLAY_SPAN);
    actor_close(&tried);
}

void cases_walk(const examination *e)
{
    walk(e, STREAM_WALK, WALK_FRAMES / e->divisor);
    play_judged();
}

void cases_restless(const examination *e)
{
    walk(e, STREAM_RESTLESS, WALK_FRAMES / e->divisor);
    play_judged();
}

void cases_hands(const examination *e)
{
    walk(e, STREAM_EXTREMES, HANDS_FRAMES / e->divisor);
    walk(e, STREAM_ABSENT, HANDS_FRAMES / e->divisor);
    walk(e, STREAM_ONE_HAND, HANDS_FRAMES / e->divisor);
    play_judged();
}

/* ---- holds ---- */

/* A fiftieth of the face's largest extent is more than a calm hand moves in one frame. */
static const double jump_in_faces = 0.02;

void cases_engage(const examination *e)
{
    uint32_t holds = 0;
    for (uint32_t round = 0; round < divided(e, ENGAGE_ROUNDS); ++round) {
        if (!play_open(&tried, &tried_hands, e, STREAM_CALM, e->seed + round))
            return;
        if (round > 0)
            stream_shuffle_choices(&tried_hands);
        tried.max_jump_mm = jump_in_faces * tried.reach_mm / 10.0;
        for (uint32_t i = 0; i < ENGAGE_FRAMES; ++i) {
            uint32_t before = tried.good.anchor;
            play_frames(&tried, &tried_hands, 1);
            holds += tried.good.anchor != before;
        }
        actor_close(&tried);
    }
    tell_ok(RULE_MAPPING_JUMP, "%u holds", holds);
}

/* ---- the time limit ---- */

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
static const double limit_us = 1000.0; /* this build itself is slow */
#else
static const double limit_us = 200.0;
#endif

/* Returns the 99th percentile of the processor time of process(). */
static double p99_us(const examination *e)
{
    static double took_us[DEADLINE_FRAMES];
    if (!play_open(&tried, &tried_hands, e, STREAM_RESTLESS, e->seed))
        return -1;
    tried.is_measured = true;
    play_frames(&tried, &tried_hands, PLAY_SPAN); /* warms up the caches */
    for (uint32_t i = 0; i < DEADLINE_FRAMES; ++i) {
        play_frames(&tried, &tried_hands, 1);
        took_us[i] = (double)tried.cpu_ns / 1e3;
    }
    actor_close(&tried);
    return percentile(took_us, DEADLINE_FRAMES, 0.99);
}

/* A slow plugin is slow in every pass. The best of some passes excludes the influence of other
 * programs. */
void cases_deadline(const examination *e)
{
    double best_us = p99_us(e);
    for (int pass = 1; pass < DEADLINE_PASSES && best_us > limit_us; ++pass) {
        double us = p99_us(e);
        best_us = us < best_us ? us : best_us;
    }
    if (best_us < 0)
        return;
    if (best_us > limit_us)
        tell_failed(RULE_FRAME_DEADLINE, "p99 of process() is %.1f us in the best of %d passes",
                    best_us, DEADLINE_PASSES);
    tell_ok(RULE_FRAME_DEADLINE, "p99 %.1f us", best_us);
}

/* ---- same take, same bits: again, beside another instance, after a reset, in another process
 * ---- */

enum { TAKE_FRAMES = 2000, RESETS = 6 };
static actor first, second, third, other;
static stream first_hands, second_hands, third_hands, other_hands;
static uint64_t sums[TAKE_FRAMES];

/* Fills new heap memory with this value instead of zeros, so that reading uninitialised memory has
 * an effect. */
static void soil(int with)
{
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    (void)mallopt(M_PERTURB, with);
#else
    (void)with;
#endif
}

static bool open_soiled(actor *out, stream *out_hands, const examination *e, stream_kind kind,
                        uint64_t seed, int with)
{
    soil(with);
    return play_open(out, out_hands, e, kind, seed);
}

/* Returns the first frame where the take differs from sums[]; TAKE_FRAMES: none. */
static uint32_t compare_take(actor *mapping, stream *hands, actor *beside, stream *beside_hands)
{
    for (uint32_t i = 0; i < TAKE_FRAMES; ++i) {
        play_frames(mapping, hands, 1);
        if (beside)
            play_frames(beside, beside_hands, 1);
        if (actor_sum(mapping) != sums[i])
            return i;
    }
    return TAKE_FRAMES;
}

static bool judge_again(const examination *e)
{
    if (!open_soiled(&first, &first_hands, e, STREAM_RESTLESS, e->seed, 0x11))
        return false;
    for (uint32_t i = 0; i < TAKE_FRAMES; ++i) {
        play_frames(&first, &first_hands, 1);
        sums[i] = actor_sum(&first);
    }
    actor_close(&first);
    if (!open_soiled(&second, &second_hands, e, STREAM_RESTLESS, e->seed, 0xd3))
        return false;
    uint32_t at = compare_take(&second, &second_hands, NULL, NULL);
    actor_close(&second);
    if (at < TAKE_FRAMES)
        tell_failed(RULE_REPLAY_SAME,
                    "the same take differs from frame %u on with a new instance. It depends on "
                    "uninitialised memory, on a variable that outlives the instance, on time or "
                    "on random numbers",
                    at);
    tell_ok(RULE_REPLAY_SAME, "%d frames", TAKE_FRAMES);
    return at == TAKE_FRAMES;
}

static void judge_beside(const examination *e)
{
    if (!open_soiled(&first, &first_hands, e, STREAM_RESTLESS, e->seed, 0x11) ||
        !open_soiled(&other, &other_hands, e, STREAM_WALK, e->seed + 7, 0xd3))
        return;
    uint32_t at = compare_take(&first, &first_hands, &other, &other_hands);
    if (at < TAKE_FRAMES)
        tell_failed(RULE_REPLAY_INSTANCES,
                    "the take differs from frame %u on when another instance performs beside "
                    "it. They share a variable",
                    at);
    tell_ok(RULE_REPLAY_INSTANCES, "%s", "");
    actor_close(&first);
    actor_close(&other);
}

/* ---- each part of a life on another thread, as in a host that loads beside the stage ---- */

enum { LIFE_PARTS = 4 }; /* begin, two halves of the take, end */
typedef struct life {
    const examination *e;
    int part;
    bool is_open, has_no_thread;
    uint32_t differs_at; /* TAKE_FRAMES: none */
} life;

static void play_life(life *of, uint32_t from, uint32_t to)
{
    for (uint32_t i = from; i < to && of->is_open && of->differs_at == TAKE_FRAMES; ++i) {
        play_frames(&first, &first_hands, 1);
        if (actor_sum(&first) != sums[i])
            of->differs_at = i;
    }
}

/* Runs one part, then the next on another thread. This thread lives until that has ended, so that
 * all threads are different. */
static void *live_part(void *data)
{
    life *of = data;
    int part = of->part++;
    pthread_t thread;
    if (part == 0)
        of->is_open = play_open(&first, &first_hands, of->e, STREAM_RESTLESS, of->e->seed);
    else if (part < LIFE_PARTS - 1)
        play_life(of, part == 1 ? 0 : TAKE_FRAMES / 2, part == 1 ? TAKE_FRAMES / 2 : TAKE_FRAMES);
    else
        actor_close(&first);
    if (part == LIFE_PARTS - 1)
        return NULL;
    if (pthread_create(&thread, NULL, live_part, of) == 0)
        (void)pthread_join(thread, NULL);
    else
        of->has_no_thread = true;
    return NULL;
}

static void judge_threads(const examination *e)
{
    life of = {.e = e, .differs_at = TAKE_FRAMES};
    (void)live_part(&of);
    if (of.has_no_thread) {
        actor_close(&first);
        tell_skipped(RULE_LIFE_THREADS, "cannot start a thread");
        return;
    }
    if (of.differs_at < TAKE_FRAMES)
        tell_failed(RULE_LIFE_THREADS,
                    "the take differs from frame %u on when create(), process() and destroy() "
                    "are called on different threads. It stores something per thread",
                    of.differs_at);
    tell_ok(RULE_LIFE_THREADS, "%s", "");
}

/* Returns false if nothing more can be judged. */
static bool judge_reset_after(const examination *e, stream_kind kind, uint64_t seed)
{
    if (!open_soiled(&first, &first_hands, e, kind, seed, 0x11))
        return false;
    play_frames(&first, &first_hands, PLAY_SPAN);
    tell_doing(RULE_COUNT, "%s, after reset()", stream_name(kind));
    actor_reset(&first);
    if (!open_soiled(&second, &second_hands, e, kind, seed + 1, 0x11) ||
        !stream_begin(&first_hands, kind, seed + 1, e->type))
        return false;
    bool is_same = play_same(&first, &first_hands, &second, &second_hands, TAKE_FRAMES,
                             RULE_REPLAY_RESET, "an instance after reset(), and a new one");
    actor_close(&first);
    actor_close(&second);
    return is_same;
}

static void judge_reset(const examination *e)
{
    const uint32_t resets = divided(e, RESETS);
    for (uint64_t i = 0; i < resets; ++i)
        if (!judge_reset_after(e, i % 2 ? STREAM_WALK : STREAM_RESTLESS, e->seed + 3 + 11 * i))
            return;
    tell_ok(RULE_REPLAY_RESET, "%u times", resets);
}

void cases_replay(const examination *e)
{
    if (!judge_again(e))
        return;
    judge_beside(e);
    judge_threads(e);
    judge_reset(e);
}

void cases_sum(const examination *e)
{
    uint64_t sum = HASH_START;
    if (!play_open(&first, &first_hands, e, STREAM_RESTLESS, e->seed))
        return;
    for (uint32_t i = 0; i < TAKE_FRAMES; ++i) {
        play_frames(&first, &first_hands, 1);
        const uint64_t shown = actor_sum(&first);
        sum = hash_bytes(sum, &shown, sizeof shown);
    }
    actor_close(&first);
    tell_fact(WIRE_SUM, "%016" PRIx64, sum);
}

/* ---- state and resume: saving and loading bytes, without other effects, and without accepting
 * invalid bytes ---- */

enum { SIZE_MAX_BYTES = 16 << 20, GUARD = 32, GUARD_BYTE = 0x5c, TRIES = 60 };
static const size_t odd_sizes[] = {0, 1, 3, 8, 31, 200, 4096};
enum { ODD_SIZES = sizeof odd_sizes / sizeof *odd_sizes };

/* The functions that save and load, of either interface. */
typedef struct store {
    size_t (*save)(mrt_plugin *self, void *out, size_t capacity);
    mrt_result (*load)(mrt_plugin *self, const void *bytes, size_t size);
    check_rule size_rule, refuses_rule, whole_rule;
    const char *name;
} store;

typedef struct kept {
    unsigned char *bytes; /* with GUARD more bytes */
    size_t size;
} kept;

static size_t save(const store *s, actor *mapping, void *out, size_t capacity)
{
    tell_doing(RULE_COUNT, "save() of %s", s->name);
    watch_next();
    actor_frame_enter();
    size_t size = s->save(mapping->self, out, capacity);
    actor_frame_leave("save()");
    return size;
}

static mrt_result load(const store *s, actor *mapping, const void *bytes, size_t size)
{
    tell_doing(RULE_COUNT, "load() of %s with %zu bytes", s->name, size);
    watch_next();
    actor_frame_enter();
    mrt_result result = s->load(mapping->self, bytes, size);
    actor_frame_leave("load()");
    return result;
}

/* ---- sizes ---- */

static bool is_guarded(const unsigned char *at)
{
    for (int i = 0; i < GUARD; ++i)
        if (at[i] != GUARD_BYTE)
            return false;
    return true;
}

/* Judges save() with that capacity. Returns false if it wrote beyond it, or returned another
 * size. */
static bool judge_capacity(const store *s, actor *mapping, const kept *of, size_t capacity)
{
    memset(of->bytes, GUARD_BYTE, of->size + GUARD);
    size_t size = save(s, mapping, of->bytes, capacity);
    if (!is_guarded(of->bytes + capacity))
        tell_failed(s->size_rule, "save() wrote beyond its capacity of %zu bytes", capacity);
    else if (size != of->size)
        tell_failed(s->size_rule,
                    "save() returned %zu bytes with a capacity of %zu, but %zu "
                    "with none",
                    size, capacity, of->size);
    else
        return true;
    return false;
}

/* Returns the saved bytes; NULL: none. */
static kept keep(const store *s, actor *mapping)
{
    kept out = {.size = save(s, mapping, NULL, 0)};
    if (out.size == 0)
        return out;
    if (out.size > SIZE_MAX_BYTES) {
        tell_failed(s->size_rule, "save() needs %zu bytes", out.size);
        return out;
    }
    out.bytes = malloc(out.size + GUARD);
    if (!out.bytes)
        return out;
    if (judge_capacity(s, mapping, &out, 0) && judge_capacity(s, mapping, &out, out.size - 1) &&
        judge_capacity(s, mapping, &out, out.size))
        return out;
    free(out.bytes);
    out.bytes = NULL;
    return out;
}

static bool is_same_kept(const kept *a, const kept *b)
{
    return a->size == b->size && memcmp(a->bytes, b->bytes, a->size) == 0;
}

/* ---- rejected bytes ---- */

/* Returns false if load() accepted them. */
static bool refuses(const store *s, actor *mapping, const void *bytes, size_t size,
                    const char *what)
{
    mrt_result result = load(s, mapping, bytes, size);
    if (result < 0)
        return true;
    tell_failed(s->refuses_rule, "load() accepted %zu bytes that are %s", size, what);
    return false;
}

static void judge_random(const store *s, actor *mapping, const kept *good, uint64_t seed)
{
    size_t capacity = good->size > 4096 ? good->size : 4096;
    unsigned char *bytes = malloc(capacity);
    for (int i = 0; bytes && i < TRIES; ++i) {
        size_t size = i % 2 ? good->size : odd_sizes[(size_t)i / 2 % ODD_SIZES];
        random_bytes(&seed, bytes, size);
        if (!refuses(s, mapping, bytes, size, size ? "random" : "empty"))
            break;
    }
    free(bytes);
}

/* Judges truncated bytes, and bytes with one flipped bit. */
static void judge_damaged(const store *s, actor *mapping, const kept *good, uint64_t seed)
{
    unsigned char *bytes = malloc(good->size);
    for (int i = 0; bytes && i < TRIES; ++i) {
        size_t size = random_below(&seed, (uint32_t)good->size);
        memcpy(bytes, good->bytes, good->size);
        if (!refuses(s, mapping, bytes, size, "truncated"))
            break;
        size_t at = random_below(&seed, (uint32_t)good->size);
        bytes[at] ^= (unsigned char)(1u << random_below(&seed, 8));
        if (!refuses(s, mapping, bytes, good->size, "damaged by one bit"))
            break;
    }
    free(bytes);
}

/* ---- state ---- */

static void judge_explained(const store *s, actor *mapping)
{
    static const char nonsense[] = "empty";
    uint32_t before = mapping->host.error_count;
    if (load(s, mapping, nonsense, sizeof nonsense) < 0 && mapping->host.error_count == before)
        tell_failed(RULE_RUN_EXPLAINED, "load() of %s rejected bytes, but logged no error",
                    s->name);
}

static void judge_state_round(const store *s, const kept *good)
{
    mrt_result result = load(s, &second, good->bytes, good->size);
    if (result < 0) {
        tell_failed(RULE_STATE_ROUND, "load() returned %d for bytes of save()", result);
        return;
    }
    kept again = keep(s, &second);
    if (again.bytes && !is_same_kept(&again, good))
        tell_failed(RULE_STATE_ROUND, "after load() and save() its %zu bytes are different (%zu)",
                    good->size, again.size);
    else if (!again.bytes && !tell_has_failed(s->size_rule))
        tell_failed(RULE_STATE_ROUND, "after load() save() returns nothing");
    free(again.bytes);
}

static void judge_state_unchanged(const store *s, const kept *before)
{
    kept after = keep(s, &first);
    if (after.bytes && !is_same_kept(&after, before))
        tell_failed(s->whole_rule, "after load() rejected bytes, save() gives other bytes than "
                                   "before");
    free(after.bytes);
}

static void judge_poses(const examination *e, const kept *good)
{
    const mrt_taught_poses *functions = types_interface(e->type, MRT_TAUGHT_POSES);
    float angle_rad[MRT_ANGLES];
    if (!functions)
        return;
    for (uint32_t i = 0; i < e->type->param_count; ++i) {
        const uint32_t id = e->type->params[i].id;
        memset(angle_rad, 0, sizeof angle_rad);
        mrt_result result = functions->pose(good->bytes, good->size, id, angle_rad);
        if (result != MRT_OK && result != MRT_END)
            tell_failed(RULE_STATE_POSES, "pose() of parameter %u returned %d for bytes of save()",
                        id, result);
        for (int k = 0; k < MRT_ANGLES; ++k)
            if (!isfinite(angle_rad[k]))
                tell_failed(RULE_STATE_POSES, "parameter %u: angle %d is not a number", id, k);
    }
    const uint32_t an_id = e->type->param_count ? e->type->params[0].id : 0;
    if (functions->pose(good->bytes, good->size - 1, an_id, angle_rad) != MRT_ERR_FORMAT ||
        functions->pose("nonsense", 8, an_id, angle_rad) != MRT_ERR_FORMAT)
        tell_failed(RULE_STATE_POSES, "pose() accepts bytes that save() did not write");
    tell_ok(RULE_STATE_POSES, "%s", "");
}

void cases_state(const examination *e)
{
    static const check_rule rules[] = {RULE_STATE_SIZE, RULE_STATE_ROUND, RULE_STATE_REFUSES,
                                       RULE_STATE_ALL_OR_NONE};
    const mrt_state *functions = types_interface(e->type, MRT_STATE);
    const store s = {functions->save,    functions->load,        RULE_STATE_SIZE,
                     RULE_STATE_REFUSES, RULE_STATE_ALL_OR_NONE, "MRT_STATE"};
    if (!play_open(&first, &first_hands, e, STREAM_WALK, e->seed) ||
        !play_open(&second, &second_hands, e, STREAM_WALK, e->seed))
        return;
    play_frames(&first, &first_hands, PLAY_SPAN);
    kept good = keep(&s, &first);
    if (good.size == 0) {
        for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
            tell_skipped(rules[i], "save() returns no bytes");
        tell_skipped(RULE_STATE_POSES, "save() returns no bytes");
        return;
    }
    if (!good.bytes)
        return;
    judge_state_round(&s, &good);
    judge_poses(e, &good);
    judge_random(&s, &first, &good, e->seed);
    if (!tell_has_failed(s.refuses_rule)) {
        judge_explained(&s, &first);
        judge_state_unchanged(&s, &good);
    }
    free(good.bytes);
    for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
        tell_ok(rules[i], "%s", "");
}

/* ---- resume ---- */

enum { MOMENTS = 12 };
static const uint32_t moments[MOMENTS] = {0,    3,    41,   137,  307,  700, /* frames */
                                          1103, 1499, 2000, 2617, 3301, 4001};
static uint64_t alone_sums[PLAY_SPAN]; /* sums of an uninterrupted instance */
static stream then_hands;              /* at that moment */
static actor then;                     /* the host's state */

/* Returns the first coming frame that differs from alone_sums[]; PLAY_SPAN: none. */
static uint32_t go_on(actor *mapping, stream *hands, const char *doing)
{
    tell_doing(RULE_COUNT, "%s, %s", stream_name(then_hands.kind), doing);
    for (uint32_t i = 0; i < PLAY_SPAN; ++i) {
        play_frames(mapping, hands, 1);
        if (actor_sum(mapping) != alone_sums[i])
            return i;
    }
    return PLAY_SPAN;
}

/* Opens a new instance and loads the state, as the stage resumes a take. The host's own state is
 * copied. */
static bool open_loaded(const store *s, const examination *e, const kept *good)
{
    actor_close(&second);
    if (!play_open(&second, &second_hands, e, then_hands.kind, e->seed))
        return false;
    mrt_result result = load(s, &second, good->bytes, good->size);
    if (result < 0) {
        tell_failed(RULE_RESUME_SAME, "load() returned %d for bytes of save()", result);
        return false;
    }
    second_hands = then_hands;
    memcpy(&second.frame, &then.frame, sizeof then.frame);
    second.room.pull = then.room.pull;
    second.good = then.good;
    second.anchored = then.anchored;
    second.has_anchored = then.has_anchored;
    return true;
}

static void judge_resumed(const store *s, const examination *e, const kept *good, uint32_t moment)
{
    if (!open_loaded(s, e, good))
        return;
    uint32_t at = go_on(&second, &second_hands, "resumed");
    if (at < PLAY_SPAN) {
        tell_failed(RULE_RESUME_SAME,
                    "resumed at frame %u, it continues the same for %u frames, then differs",
                    moment, at);
        return;
    }
    if (!open_loaded(s, e, good))
        return;
    judge_random(s, &second, good, e->seed);
    judge_damaged(s, &second, good, e->seed);
    if (!tell_has_failed(s->refuses_rule) &&
        go_on(&second, &second_hands, "after load() rejected") < PLAY_SPAN)
        tell_failed(s->whole_rule, "after load() rejected bytes, it continues differently");
}

/* Returns false if nothing more can be judged. */
static bool judge_moment(const store *s, const examination *e, stream_kind kind, uint32_t moment)
{
    if (!play_open(&first, &first_hands, e, kind, e->seed) ||
        !play_open(&third, &third_hands, e, kind, e->seed))
        return false;
    play_frames(&first, &first_hands, moment);
    play_frames(&third, &third_hands, moment);
    for (uint32_t i = 0; i < PLAY_SPAN; ++i) {
        play_frames(&third, &third_hands, 1);
        alone_sums[i] = actor_sum(&third);
    }
    then_hands = first_hands;
    then = first;
    kept good = keep(s, &first);
    bool can_go_on = good.bytes != NULL;
    if (good.size == 0)
        tell_skipped(RULE_RESUME_SAME, "save() returned no bytes at frame %u", moment);
    if (can_go_on && go_on(&first, &first_hands, "after save()") < PLAY_SPAN) {
        tell_failed(RULE_RESUME_SILENT, "after save() at frame %u it continues differently",
                    moment);
        can_go_on = false;
    }
    if (can_go_on)
        judge_resumed(s, e, &good, moment);
    free(good.bytes);
    actor_close(&first);
    actor_close(&second);
    actor_close(&third);
    return can_go_on;
}

void cases_resume(const examination *e)
{
    static const check_rule rules[] = {RULE_RESUME_SIZE, RULE_RESUME_SAME, RULE_RESUME_SILENT,
                                       RULE_RESUME_REFUSES, RULE_RESUME_ALL_OR_NONE};
    const mrt_resume *functions = types_interface(e->type, MRT_RESUME);
    const store s = {functions->save,     functions->load,         RULE_RESUME_SIZE,
                     RULE_RESUME_REFUSES, RULE_RESUME_ALL_OR_NONE, "MRT_RESUME"};
    const uint32_t count = 2 * divided(e, MOMENTS / 2);
    for (uint32_t i = 0; i < count; ++i)
        if (!judge_moment(&s, e, i % 2 ? STREAM_WALK : STREAM_RESTLESS, moments[i]))
            return;
    for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
        tell_ok(rules[i], "%u moments", count);
}
