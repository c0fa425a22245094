/* hostile_heads [SECONDS [SEED [COUNT]]] - takes the heads at hand (rigs/, seeds of the fuzz
 * targets, $MAROTTE_SHARED), changes each by chance (numbers, words and members of JSON, words of
 * text, floats and bytes of the rest) and gives it to marotte rig new, rig check and perform with
 * every mapping and every export. Exit codes 0 and 1 are right. A signal, a report of a sanitizer,
 * another exit code, more than 60 s or more memory than 20 times the file and 1.5 GB are findings:
 * BUILD_DIR/hostile_heads/SEED has the head and how to run it. Each head has a seed of its own:
 * hostile_heads 60 SEED 1 makes that one again, where the same heads are at hand. ./test --long
 * runs it for an hour. */
#include "base/clock.h"

#include <dirent.h>
#include <errno.h>
#include <jansson.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATH = 512, HEADS_MAX = 512, WORDS_MAX = 64, SKIPPED = 77, WALL_MAX_S = 900 };
enum { FILE_MAX = 6 << 20, TINY = 4 << 10, LARGE = 1 << 20, FINDINGS_MAX = 200 };
static const double limit_s = 60.0, bytes_per_byte = 20.0, bytes_beside = 1.5e9;

typedef enum kind { KIND_NONE = 0, KIND_GLB, KIND_JSON, KIND_TEXT, KIND_BYTES } kind;

typedef struct head {
    char path[PATH];
    size_t size;
} head;

typedef struct bytes {
    char *at;
    size_t size, room;
} bytes;

typedef struct trial {
    char folder[PATH / 2], mesh[PATH], rig[PATH], program[PATH], findings[PATH], source[PATH / 2];
    head heads[HEADS_MAX];
    size_t head_count;
    uint64_t seed, random;
    bool has_pictures;
    /* what was seen */
    uint64_t made, commands, refused, performed, finding_count;
    uint64_t unchecked; /* commands whose leaks could not be looked for */
    double longest_s, most_bytes;
    char longest_what[PATH];
} trial;

/* ---- chance ---- */

static uint64_t draw(trial *t, uint64_t count) /* SplitMix64 */
{
    uint64_t n = t->random += 0x9e3779b97f4a7c15u;
    n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9u;
    n = (n ^ (n >> 27)) * 0x94d049bb133111ebu;
    return (n ^ (n >> 31)) % count;
}

/* ---- files ---- */

static void must(bool good, const char *what)
{
    if (good)
        return;
    fprintf(stderr, "hostile_heads: %s: %s\n", what, strerror(errno));
    exit(1);
}

static bytes read_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    bytes out = {NULL, 0, 0};
    if (file && fseek(file, 0, SEEK_END) == 0) {
        long size = ftell(file);
        rewind(file);
        out.room = 2 * (size_t)(size > 0 ? size : 0) + 4096;
        out.at = calloc(out.room, 1);
        must(out.at != NULL, "memory");
        out.size = fread(out.at, 1, (size_t)(size > 0 ? size : 0), file);
    }
    if (file)
        (void)fclose(file);
    return out;
}

static void write_file(const char *path, const void *at, size_t size)
{
    FILE *file = fopen(path, "wb");
    must(file && fwrite(at, 1, size, file) == size && fclose(file) == 0, path);
}

/* What a shell does with two paths, "$1" and "$2". */
static void shell(const char *script, const char *one, const char *two)
{
    char command[4 * PATH];
    (void)snprintf(command, sizeof command, "set -- '%s' '%s'; %s", one, two, script);
    (void)!system(command);
}

static const char *ending_of(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot ? dot : "";
}

static kind kind_of(const char *path, const bytes *of)
{
    static const char *const known[] = {".glb", ".vrm", ".gltf", ".json",
                                        ".obj", ".off", ".ply",  ".stl"};
    size_t i = 0, count = sizeof known / sizeof known[0];
    while (i < count && strcasecmp(ending_of(path), known[i]) != 0)
        ++i;
    if (i < 4 && of && of->size > 20 && memcmp(of->at, "glTF", 4) == 0)
        return KIND_GLB;
    if (i < 4)
        return KIND_JSON;
    if (i < 6)
        return KIND_TEXT;
    return i == count ? KIND_NONE : of && !memchr(of->at, 0, of->size) ? KIND_TEXT : KIND_BYTES;
}

static void add_folder(trial *t, const char *folder)
{
    DIR *opened = opendir(folder);
    for (struct dirent *entry; opened && (entry = readdir(opened));) {
        head *to = &t->heads[t->head_count];
        struct stat status;
        int length = snprintf(to->path, PATH, "%s/%s", folder, entry->d_name);
        if (t->head_count == HEADS_MAX || length >= PATH || entry->d_name[0] == '.' ||
            kind_of(to->path, NULL) == KIND_NONE || strcmp(ending_of(to->path), ".json") == 0 ||
            stat(to->path, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size > FILE_MAX)
            continue;
        to->size = (size_t)status.st_size;
        t->head_count += 1;
    }
    if (opened)
        (void)closedir(opened);
}

static int compare_heads(const void *a, const void *b)
{
    return strcmp(((const head *)a)->path, ((const head *)b)->path);
}

static void find_heads(trial *t)
{
    static const char *const own[] = {"rigs/moai",
                                      "rigs/puppet",
                                      "rigs/plane",
                                      "tests/fuzz/seeds/gltf",
                                      "tests/fuzz/seeds/obj",
                                      "tests/fuzz/seeds/ply",
                                      "tests/fuzz/seeds/off"};
    static const char *const theirs[] = {"data/heads", "data/heads2", "data/faces"};
    const char *shared = getenv("MAROTTE_SHARED");
    char folder[PATH];
    for (size_t i = 0; i < sizeof own / sizeof own[0]; ++i) {
        (void)snprintf(folder, sizeof folder, "%s/%s", t->source, own[i]);
        add_folder(t, folder);
    }
    size_t before = t->head_count;
    for (size_t i = 0; i < sizeof theirs / sizeof theirs[0]; ++i) {
        (void)snprintf(folder, sizeof folder, "%s%s/%s", shared ? shared : t->source,
                       shared ? "" : "/../shared", theirs[i]);
        add_folder(t, folder);
    }
    if (t->head_count == before)
        printf("no heads in %s: those of the repository alone\n", shared ? shared : "../shared");
    qsort(t->heads, t->head_count, sizeof *t->heads, compare_heads);
    must(t->head_count > 0, "no heads");
}

/* ---- changes ---- */

static const char *const numbers[] = {
    "0",    "1",     "2",     "3",          "-1",          "7",          "12",
    "255",  "1000",  "20000", "65535",      "0.5",         "1e-30",      "-0.0",
    "1e30", "1e308", "-1e30", "2147483647", "-2147483648", "4294967296", "1e-6",
    "1e6",  "0.001", "5120",  "5121",       "5123",        "5125",       "5126"};
enum { NUMBERS = sizeof numbers / sizeof numbers[0] };

/* In place of `length` bytes. What would not fit is left out. */
static void replace(bytes *of, size_t at, size_t length, const char *with, size_t with_length)
{
    if (at + length > of->size || of->size - length + with_length > of->room)
        return;
    memmove(of->at + at + with_length, of->at + at + length, of->size - at - length);
    memmove(of->at + at, with, with_length);
    of->size += with_length - length;
}

static void replace_by_number(trial *t, bytes *of, size_t at, size_t length)
{
    const char *with = numbers[draw(t, NUMBERS)];
    replace(of, at, length, with, strlen(with));
}

static bool is_of_number(char c)
{
    return c && strchr("0123456789+-.eE", c);
}

typedef struct span {
    size_t at, length;
} span;

/* From `at` on to the end of the JSON item or member that begins there. */
static span value_at(const bytes *of, size_t at)
{
    size_t end = at;
    int depth = 0;
    bool is_text = false;
    for (; end < of->size; ++end) {
        char c = of->at[end];
        if (is_text) {
            end += c == '\\';
            is_text = c != '"';
            continue;
        }
        if (depth == 0 && (c == ',' || c == '}' || c == ']'))
            break;
        is_text = c == '"';
        depth += c == '{' || c == '[';
        depth -= c == '}' || c == ']';
    }
    return (span){at, end < of->size ? end - at : of->size - at};
}

/* The first after a place by chance of what begins after one of these letters. */
static bool find_after(trial *t, const bytes *of, const char *letters, span *out)
{
    if (of->size < 4)
        return false;
    size_t start = (size_t)draw(t, of->size);
    for (size_t i = 0; i < of->size; ++i) {
        size_t at = (start + i) % of->size;
        if (!strchr(letters, of->at[at]) || !of->at[at] || at + 1 >= of->size)
            continue;
        *out = value_at(of, at + 1);
        return out->length > 0 && out->at + out->length <= of->size;
    }
    return false;
}

/* A number by chance. */
static bool find_number(trial *t, const bytes *of, span *out)
{
    size_t start = of->size ? (size_t)draw(t, of->size) : 0;
    for (size_t i = start; i + 1 < of->size; ++i)
        if (of->at[i] && strchr(":,[ ", of->at[i]) && of->at[i + 1] &&
            strchr("0123456789-", of->at[i + 1])) {
            *out = (span){i + 1, 1};
            while (out->at + out->length < of->size && is_of_number(of->at[out->at + out->length]))
                out->length += 1;
            return true;
        }
    return false;
}

static void copy_over(bytes *of, span from, span to)
{
    char *copy = malloc(from.length + 1);
    must(copy != NULL, "memory");
    memcpy(copy, of->at + from.at, from.length);
    copy[from.length] = ',';
    replace(of, to.at, to.length, copy, from.length + (to.length == 0));
    free(copy);
}

static void change_json_once(trial *t, bytes *of)
{
    static const char *const values[] = {"null", "true", "{}",  "[]",
                                         "\"\"", "-1",   "[0]", "{\"a\":0}"};
    enum { VALUES = sizeof values / sizeof values[0] };
    span one, other;
    const uint64_t how = draw(t, 12);
    if (how < 3 && find_number(t, of, &one)) {
        replace_by_number(t, of, one.at, one.length);
    } else if (how < 6 && find_number(t, of, &one) && find_number(t, of, &other)) {
        copy_over(of, one, other); /* most likely of something that is there */
    } else if (how < 8 && find_after(t, of, ":[", &one)) {
        const char *with = values[draw(t, VALUES)];
        replace(of, one.at, one.length, with, strlen(with));
    } else if (how < 10 && find_after(t, of, "{,[", &one)) { /* a member or an item less */
        bool is_last = one.at + one.length < of->size && of->at[one.at + one.length] != ',';
        bool has_before = is_last && of->at[one.at - 1] == ',';
        replace(of, one.at - has_before, one.length + (!is_last || has_before), "", 0);
    } else if (find_after(t, of, ":,[", &one) && find_after(t, of, ":,[", &other)) {
        if (how == 11)
            other.length = 0; /* one more */
        copy_over(of, one, other);
    }
}

/* What is no JSON is refused at once: one in ten stays so. */
static void change_json(trial *t, bytes *of)
{
    for (int tries = 0; tries < 10; ++tries) {
        bytes changed = {calloc(of->room, 1), of->size, of->room};
        must(changed.at != NULL, "memory");
        memcpy(changed.at, of->at, of->size);
        change_json_once(t, &changed);
        json_t *read = json_loadb(changed.at, changed.size, 0, NULL);
        bool is_kept = read || draw(t, 100) == 0;
        if (is_kept) {
            free(of->at);
            *of = changed;
        } else {
            free(changed.at);
        }
        json_decref(read);
        if (is_kept)
            return;
    }
}

static void change_text(trial *t, bytes *of)
{
    if (of->size < 4)
        return;
    size_t start = (size_t)draw(t, of->size), end;
    const uint64_t how = draw(t, 8);
    const char *between = how < 6 ? " \n\t/" : "\n";
    while (start < of->size && strchr(between, of->at[start]))
        ++start;
    while (start > 0 && !strchr(between, of->at[start - 1]))
        --start;
    for (end = start; end < of->size && !strchr(between, of->at[end]);)
        ++end;
    if (how < 2)
        replace_by_number(t, of, start, end - start);
    else if (how < 5) { /* a word of the neighbourhood, most likely of the same kind */
        size_t from = start > 300 ? start - (size_t)draw(t, 300) : (size_t)draw(t, start + 1), to;
        while (from > 0 && !strchr(between, of->at[from - 1]))
            --from;
        for (to = from; to < of->size && !strchr(between, of->at[to]);)
            ++to;
        if (to > from && to - from < 64) {
            char copy[64];
            memcpy(copy, of->at + from, to - from);
            replace(of, start, end - start, copy, to - from);
        }
    } else if (how < 7) /* the word, the line is not there */
        replace(of, start, end - start, "", 0);
    else if (end < of->size) { /* the line is there twice, elsewhere */
        char *copy = malloc(end + 1 - start);
        must(copy != NULL, "memory");
        memcpy(copy, of->at + start, end + 1 - start);
        size_t to = (size_t)draw(t, of->size);
        while (to > 0 && of->at[to - 1] != '\n')
            --to;
        replace(of, to, 0, copy, end + 1 - start);
        free(copy);
    }
}

/* One axis of all points of an .obj is stretched, flattened or turned round. */
static void change_shape(trial *t, bytes *of)
{
    static const char *const exponents[] = {"e-30", "e-3", "e-1", "e0", "e1", "e3", "e25"};
    const char *with = exponents[draw(t, sizeof exponents / sizeof exponents[0])];
    const uint64_t axis = draw(t, 3);
    bytes out = {calloc(of->room, 1), 0, of->room};
    must(out.at != NULL, "memory");
    uint64_t word = 0;
    bool is_point = false;
    for (size_t i = 0; i < of->size && out.size + 8 < out.room; ++i) {
        char c = of->at[i];
        bool ends = c == ' ' || c == '\n';
        if (ends && is_point && word == axis + 1 && i > 0 && of->at[i - 1] != ' ') {
            memcpy(out.at + out.size, with, strlen(with));
            out.size += strlen(with);
        }
        if (c == '\n' || i == 0) {
            is_point =
                of->size - i > 2 && of->at[i + (i > 0)] == 'v' && of->at[i + (i > 0) + 1] == ' ';
            word = 0;
        }
        word += c == ' ';
        out.at[out.size++] = c;
    }
    free(of->at);
    *of = out;
}

static void change_bytes(trial *t, bytes *of)
{
    static const float floats[] = {0.0f, 1.0f, -1.0f, 1e-30f, 1e30f, 1e-3f, 1e3f, 1e9f};
    static const float factors[] = {0.0f, -1.0f, 0.5f, 2.0f, 10.0f, -10.0f, 1e-6f, 1e3f};
    if (of->size < 16)
        return;
    const size_t words = of->size / 4;
    switch (draw(t, 4)) {
    case 0: /* bits anywhere */
        for (uint64_t i = 1 + draw(t, 8); i-- > 0;)
            of->at[draw(t, of->size)] ^= (char)(1u << draw(t, 8));
        break;
    case 1: /* numbers: many by a factor, or some others */
        if (draw(t, 2) == 0) {
            size_t first = (size_t)draw(t, words), count = (size_t)draw(t, words - first);
            const size_t stride = 1 + (size_t)draw(t, 3);
            const float factor = factors[draw(t, sizeof factors / sizeof factors[0])];
            for (size_t i = first; i < first + count; i += stride) {
                float value;
                memcpy(&value, of->at + 4 * i, sizeof value);
                if (!(value > -1e4f && value < 1e4f) || (value < 1e-6f && value > -1e-6f))
                    continue; /* most likely no float */
                value *= factor;
                memcpy(of->at + 4 * i, &value, sizeof value);
            }
            break;
        }
        for (uint64_t i = 1 + draw(t, 8); i-- > 0;) {
            float value = floats[draw(t, sizeof floats / sizeof floats[0])];
            memcpy(of->at + 4 * draw(t, words), &value, sizeof value);
        }
        break;
    case 2: { /* a stretch of numbers is one */
        size_t first = (size_t)draw(t, words), count = (size_t)draw(t, words - first) / 4;
        for (size_t i = 0; i < count; ++i)
            memcpy(of->at + 4 * (first + i), of->at + 4 * first, 4);
        break;
    }
    default: { /* a stretch instead of another */
        size_t count = (size_t)draw(t, words) / 4, from = (size_t)draw(t, words - count),
               to = (size_t)draw(t, words - count);
        memmove(of->at + 4 * to, of->at + 4 * from, 4 * count);
    }
    }
}

static void put_u32(char *at, size_t value)
{
    for (int shift = 0; shift < 32; shift += 8)
        *at++ = (char)(value >> shift);
}

static size_t get_u32(const char *at)
{
    size_t value = 0;
    for (int i = 3; i >= 0; --i)
        value = value << 8 | (unsigned char)at[i];
    return value;
}

/* The container is in order afterwards: what is in it is to be read. */
static void change_glb(trial *t, bytes *of)
{
    enum { START = 20 };
    size_t length = get_u32(of->at + 12);
    if (length > of->size - START)
        return;
    bytes json = {calloc(2 * length + 4096, 1), length, 2 * length + 4096};
    bytes rest = {of->at + START + length, of->size - START - length, of->size - START - length};
    bytes out = {NULL, 0, 0};
    must(json.at != NULL, "memory");
    memcpy(json.at, of->at + START, length);
    if (draw(t, 4) > 0)
        for (uint64_t i = 1 + draw(t, 2); i-- > 0;)
            change_json(t, &json);
    else if (rest.size > 8) {
        bytes inner = {rest.at + 8, rest.size - 8, rest.size - 8};
        change_bytes(t, &inner);
    }
    while (json.size % 4 && json.size < json.room)
        json.at[json.size++] = ' ';
    out.room = out.size = START + json.size + rest.size;
    out.room += 4096;
    out.at = calloc(out.room, 1);
    must(out.at != NULL, "memory");
    memcpy(out.at, of->at, START);
    memcpy(out.at + START, json.at, json.size);
    memcpy(out.at + START + json.size, rest.at, rest.size);
    put_u32(out.at + 8, out.size);
    put_u32(out.at + 12, json.size);
    free(json.at);
    free(of->at);
    *of = out;
}

static void change(trial *t, bytes *of, const char *path)
{
    const kind is = kind_of(path, of);
    if (draw(t, 40) == 0)
        of->size = (size_t)draw(t, of->size + 1);
    else if (is == KIND_GLB)
        change_glb(t, of);
    else if (is == KIND_TEXT && draw(t, 4) == 0)
        change_shape(t, of);
    else
        for (uint64_t i = 1 + draw(t, 2); i-- > 0;) {
            if (is == KIND_JSON)
                change_json(t, of);
            else if (is == KIND_TEXT)
                change_text(t, of);
            else
                change_bytes(t, of);
        }
}

/* ---- one command ---- */

static double now_s(void)
{
    return (double)clock_now_ns() / 1e9;
}

static double used_s(const struct rusage *used)
{
    return (double)(used->ru_utime.tv_sec + used->ru_stime.tv_sec) +
           (double)(used->ru_utime.tv_usec + used->ru_stime.tv_usec) / 1e6;
}

static void report(trial *t, const char *what, const char *line)
{
    char folder[2 * PATH], path[3 * PATH];
    ++t->finding_count;
    printf("FOUND: seed %llu: %s: %s\n", (unsigned long long)t->seed, what, line);
    shell("grep -am 3 -E 'Sanitizer|runtime error|Assertion' \"$1/stderr\" || "
          "tail -n 2 \"$1/stderr\"",
          t->folder, "");
    (void)fflush(stdout);
    if (t->finding_count > FINDINGS_MAX)
        return;
    (void)snprintf(folder, sizeof folder, "%s/%llu", t->findings, (unsigned long long)t->seed);
    shell("mkdir -p \"$1\" && cp -a \"$2/.\" \"$1/\"", folder, t->folder);
    (void)snprintf(path, sizeof path, "%s/command", folder);
    write_file(path, line, strlen(line));
}

static void become(const trial *t, char *const *words)
{
    char out[PATH], err[PATH];
    const struct rlimit size = {1u << 30, 1u << 30}, core = {0, 0}, cpu = {150, 150};
    (void)snprintf(out, sizeof out, "%s/stdout", t->folder);
    (void)snprintf(err, sizeof err, "%s/stderr", t->folder);
    (void)setrlimit(RLIMIT_FSIZE, &size);
    (void)setrlimit(RLIMIT_CORE, &core);
    (void)setrlimit(RLIMIT_CPU, &cpu);
    if (chdir(t->folder) == 0 && freopen("/dev/null", "r", stdin) && freopen(out, "w", stdout) &&
        freopen(err, "w", stderr))
        execv(words[0], words);
    _exit(127);
}

static bool says(const trial *t, const char *words)
{
    char path[PATH];
    (void)snprintf(path, sizeof path, "%s/stderr", t->folder);
    bytes text = read_file(path);
    bool found = text.at && strstr(text.at, words);
    free(text.at);
    return found;
}

/* Words with a space between them; the exit code, -1: none. */
static int run(trial *t, const char *line, size_t size)
{
    char text[4 * PATH], *words[WORDS_MAX + 1] = {t->program};
    struct rusage used = {0};
    int status = 0, count = 1;
    (void)snprintf(text, sizeof text, "%s", line);
    for (char *at = text; *at && count < WORDS_MAX;) {
        words[count++] = at;
        at += strcspn(at, " ");
        if (*at)
            *at++ = '\0';
    }
    const double begun_s = now_s();
    (void)fflush(NULL);
    pid_t child = fork();
    must(child >= 0, "fork");
    if (child == 0)
        become(t, words);
    bool is_killed = false;
    for (double wait_s = 0.001; wait4(child, &status, WNOHANG, &used) == 0;) {
        if (now_s() - begun_s > WALL_MAX_S && !is_killed) {
            is_killed = true;
            (void)kill(child, SIGKILL);
        }
        clock_sleep_until_ns(clock_now_ns() + (int64_t)(wait_s * 1e9));
        wait_s = wait_s < 0.02 ? 1.5 * wait_s : wait_s;
    }
    const double wall_s = now_s() - begun_s,
                 took_s = wall_s < used_s(&used) ? wall_s : used_s(&used);
    const double memory = (double)used.ru_maxrss * 1024.0;
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    ++t->commands;
    t->refused += code == 1;
    t->performed += code == 0 && strncmp(line, "perform", 7) == 0;
    if (took_s > t->longest_s) {
        t->longest_s = took_s;
        (void)snprintf(t->longest_what, sizeof t->longest_what, "%.80s, seed %llu", line,
                       (unsigned long long)t->seed);
    }
    t->most_bytes = memory > t->most_bytes ? memory : t->most_bytes;
    if (is_killed || took_s > limit_s)
        report(t, "takes too long", line);
    else if (code < 0)
        report(t, strsignal(WTERMSIG(status)), line);
    else if (says(t, "LeakSanitizer has encountered a fatal error") && !says(t, "ERROR:") &&
             !says(t, "runtime error:"))
        ++t->unchecked; /* the leak checker could not stop a thread; the program itself had ended */
    else if (says(t, "Sanitizer") || says(t, "runtime error:") || says(t, "Assertion"))
        report(t, "a sanitizer's report", line);
    else if (code > 1)
        report(t,
               code == 127 ? "the program cannot be started" : "ends by another code than 0 or 1",
               line);
    else if (memory > bytes_per_byte * (double)size + bytes_beside)
        report(t, "takes too much memory", line);
    return code;
}

/* ---- one head ---- */

static const char *const mappings[] = {"anchored", "unanchored", "one_hand", "gesture",
                                       "magnet",   "poses",      "sculpt",   "tongs"};
/* Those that a face may lack come last: what is refused ends the others. */
static const char *const exports[] = {".glb", ".csv", ".usda", ".points.usda",  ".pc2",
                                      ".mdd", ".bvh", ".png",  ".livelink.csv", ".vrma"};
enum {
    MAPPINGS = sizeof mappings / sizeof mappings[0],
    EXPORTS = sizeof exports / sizeof exports[0]
};

static void perform(trial *t, const char *face, size_t size, bool is_vrm)
{
    char files[PATH] = "", line[4 * PATH], other[PATH];
    size_t used = 0;
    const uint64_t mapping = draw(t, MAPPINGS), start = draw(t, 40);
    (void)snprintf(other, sizeof other, "--input log:%s/plugins/log/demo_left_hand.csv", t->source);
    const bool is_bare = draw(t, 6) == 0, has_two = draw(t, 3) == 0;
    for (size_t i = 0; i < EXPORTS; ++i) {
        const bool is_picture = strcmp(exports[i], ".png") == 0;
        if (i > 0 && (draw(t, 3) > 0 || (is_picture && (!t->has_pictures || draw(t, 4) > 0))))
            continue;
        used +=
            (size_t)snprintf(files + used, sizeof files - used, " --export out/o%s", exports[i]);
    }
    if (is_vrm)
        (void)snprintf(files + used, sizeof files - used, " --export out/v.vrm");
    (void)snprintf(line, sizeof line,
                   "perform --face %s --map %s --input log:%s/plugins/log/demo_hand.csv,start=%.1f "
                   "%s --seconds 0.4 --fps 15%s%s",
                   face, mappings[mapping], t->source, 0.1 * (double)start,
                   has_two ? other : "--mirror", is_bare ? " --bare" : "", files);
    (void)run(t, line, size);
}

static void one_head(trial *t)
{
    char name[64], sibling[PATH], line[PATH];
    const head *of = NULL;
    for (int i = 0; i < 4;
         ++i) { /* large ones are slow; those of fuzz targets are most often no heads */
        of = &t->heads[draw(t, t->head_count)];
        if (of->size < LARGE && (of->size > TINY || draw(t, 8) == 0))
            break;
    }
    shell("rm -rf \"$1\"/* && mkdir -p \"$1/out\"", t->folder, "");
    bytes content = read_file(of->path);
    must(content.at != NULL, of->path);
    if (draw(t, 16) > 0)
        change(t, &content, of->path);
    (void)snprintf(name, sizeof name, "head%s", ending_of(of->path));
    (void)snprintf(t->mesh, sizeof t->mesh, "%s/%s", t->folder, name);
    write_file(t->mesh, content.at, content.size);
    (void)snprintf(sibling, sizeof sibling, "%s/from", t->folder);
    write_file(sibling, of->path, strlen(of->path));
    const size_t size = content.size;
    const bool is_vrm = strcmp(ending_of(name), ".vrm") == 0;
    free(content.at);
    t->made += 1;
    (void)snprintf(line, sizeof line, "rig new %s%s", name, draw(t, 8) ? "" : " --cut-mouth");
    const bool has_rig = run(t, line, size) == 0;
    if (draw(t, 3) == 0 || !has_rig)
        perform(t, name, size, is_vrm);
    if (!has_rig)
        return;
    if (draw(t, 4) == 0) {
        (void)snprintf(t->rig, sizeof t->rig, "%s/head.rig.json", t->folder);
        content = read_file(t->rig);
        must(content.at != NULL, t->rig);
        change(t, &content, t->rig);
        write_file(t->rig, content.at, content.size);
        free(content.at);
    }
    if (draw(t, 4) == 0)
        (void)run(t, "rig check head.rig.json", size);
    if (t->has_pictures && draw(t, 16) == 0)
        (void)run(t, "rig show head.rig.json --out out/r.png --size 320x240", size);
    if (draw(t, 8) == 0)
        (void)run(t, "rig show head.rig.json --poses", size);
    perform(t, "head.rig.json", size, is_vrm);
}

/* ---- the whole ---- */

static const char *setting(const char *name, const char *otherwise)
{
    const char *text = getenv(name);
    return text && text[0] ? text : otherwise;
}

static void prepare(trial *t)
{
    (void)snprintf(t->source, sizeof t->source, "%s", setting("SOURCE_DIR", SOURCE_DIR));
    (void)snprintf(t->program, sizeof t->program, "%s", setting("MAROTTE", BUILD_DIR "/marotte"));
    (void)snprintf(t->findings, sizeof t->findings, "%s/hostile_heads",
                   setting("BUILD_DIR", BUILD_DIR));
    (void)snprintf(t->folder, sizeof t->folder, "%s/marotte_heads_XXXXXX",
                   setting("TMPDIR", "/tmp"));
    must(mkdtemp(t->folder) != NULL, t->folder);
    static const char *const own[] = {"XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_DOCUMENTS_DIR",
                                      "TMPDIR"};
    for (size_t i = 0; i < sizeof own / sizeof own[0]; ++i)
        (void)setenv(own[i], t->folder, 1);
    (void)setenv("ASAN_OPTIONS", "hard_rss_limit_mb=6000:allocator_may_return_null=1", 0);
    find_heads(t);
}

static void find_out_about_pictures(trial *t)
{
    char line[2 * PATH];
    (void)snprintf(line, sizeof line,
                   "rig show %s/rigs/moai/moai.rig.json --out r.png --size 320x240", t->source);
    t->has_pictures = run(t, line, 0) == 0;
    if (!t->has_pictures)
        printf("SKIPPED: pictures, which need OpenGL\n");
}

int main(int argc, char **argv)
{
    trial *t = calloc(1, sizeof *t);
    must(t != NULL, "memory");
    const double seconds = argc > 1 ? atof(argv[1]) : 20.0;
    const uint64_t first = argc > 2 ? strtoull(argv[2], NULL, 10) : 1,
                   count = argc > 3 ? strtoull(argv[3], NULL, 10) : UINT64_MAX;
    if (access(setting("MAROTTE", BUILD_DIR "/marotte"), X_OK) != 0) {
        printf("SKIPPED: %s is not built\n", setting("MAROTTE", BUILD_DIR "/marotte"));
        return SKIPPED;
    }
    prepare(t);
    const double begun_s = now_s();
    find_out_about_pictures(t);
    for (uint64_t i = 0; i < count && now_s() - begun_s < seconds; ++i) {
        t->seed = t->random = first + i;
        one_head(t);
    }
    printf(
        "%llu heads of %zu, %llu commands (%llu refused, %llu performances): %llu findings; seeds "
        "from %llu; leaks of %llu commands not checked; the longest took %.1f s (%s); at most %.0f "
        "MB\n",
        (unsigned long long)t->made, t->head_count, (unsigned long long)t->commands,
        (unsigned long long)t->refused, (unsigned long long)t->performed,
        (unsigned long long)t->finding_count, (unsigned long long)first,
        (unsigned long long)t->unchecked, t->longest_s, t->longest_what, t->most_bytes / 1e6);
    const bool failed = t->finding_count > 0;
    shell("rm -rf \"$1\"", t->folder, "");
    free(t);
    return failed;
}
