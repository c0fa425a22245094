/* hostile_shows [SECONDS] [SEED] - makes shows that nobody would record (good ones changed by bytes
 * and by SQL, with journals and links beside them) and gives each to the subcommands of marotte
 * take, to marotte perform --record and to the hidden stage. None may crash, take more than 10 s or
 * 20 times the file's bytes and 300 MB, touch another file, print what steers a terminal, or go on
 * after SIGTERM. The first shows are those that were found once. What fails is left in
 * BUILD_DIR/hostile_shows. ./test runs it for a moment, ./test --long for an hour. */
#include "base/clock.h"
#include "base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sqlite3.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PATH = 512, WORDS_MAX = 16, PAGE = 4096, WALL_MAX_S = 600, SKIPPED = 77 };
static const double limit_s = 10.0, stop_limit_s = 1.5, poll_s = 0.002;
static const double bytes_per_byte = 20.0, bytes_beside = 300e6;

typedef struct trial {
    char folder[128], show[160], victim[160], program[PATH], face[PATH], demo[PATH];
    char findings[PATH], source[PATH / 2], build[PATH / 2];
    bool is_long;
    uint64_t random;
    bool has_stage;
    /* what was seen */
    uint64_t files, commands, stopped, refused, failures;
    double longest_s, longest_stop_s, largest_share;
    char longest_what[160];
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
    fprintf(stderr, "hostile_shows: %s: %s\n", what, strerror(errno));
    exit(1);
}

static unsigned char *read_file(const char *path, size_t *out_size)
{
    FILE *file = fopen(path, "rb");
    *out_size = 0;
    if (!file)
        return NULL;
    (void)fseek(file, 0, SEEK_END);
    long size = ftell(file);
    (void)fseek(file, 0, SEEK_SET);
    unsigned char *bytes = malloc((size_t)(size > 0 ? size : 0) + 1);
    must(bytes != NULL, "memory");
    *out_size = fread(bytes, 1, (size_t)(size > 0 ? size : 0), file);
    bytes[*out_size] = 0;
    (void)fclose(file);
    return bytes;
}

static void write_file(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    must(file && fwrite(bytes, 1, size, file) == size && fclose(file) == 0, path);
}

static void beside(const trial *t, const char *ending, char out[PATH])
{
    (void)snprintf(out, PATH, "%s%s", t->show, ending);
}

static void clear(const trial *t)
{
    char command[2 * PATH];
    (void)snprintf(command, sizeof command, "rm -rf '%s'/* && mkdir -p '%s/out'", t->folder,
                   t->folder);
    must(system(command) == 0, "the folder cannot be emptied");
}

static void start_anew(trial *t)
{
    char golden[2 * PATH];
    size_t size;
    clear(t);
    (void)snprintf(golden, sizeof golden, "%s/tests/take/golden/four_takes.marotte", t->source);
    unsigned char *bytes = read_file(golden, &size);
    must(size > 0, golden);
    write_file(t->show, bytes, size);
    write_file(t->victim, "precious", 8);
    free(bytes);
}

static bool run_sql(const trial *t, const char *sql)
{
    sqlite3 *db;
    bool good = sqlite3_open(t->show, &db) == SQLITE_OK;
    good = good && sqlite3_exec(db, sql, NULL, NULL, NULL) == SQLITE_OK;
    sqlite3_close(db);
    return good;
}

/* ---- one command ---- */

static void report(trial *t, const char *what, char *const *words)
{
    char command[6 * PATH];
    ++t->failures;
    printf("FAILED: %s:", what);
    for (int i = 0; words[i]; ++i)
        printf(" %s", words[i]);
    printf("\n");
    (void)snprintf(command, sizeof command,
                   "mkdir -p '%s/%llu' && cp -a '%s'/. '%s/%llu/' 2>/dev/null; head -c 600 "
                   "'%s/stderr'",
                   t->findings, (unsigned long long)t->failures, t->folder, t->findings,
                   (unsigned long long)t->failures, t->folder);
    (void)!system(command);
    (void)fflush(stdout);
}

static void become(const trial *t, char *const *words)
{
    char out[PATH], err[PATH];
    const struct rlimit size = {1u << 30, 1u << 30}, core = {0, 0}, cpu = {30, 30};
    (void)snprintf(out, sizeof out, "%s/stdout", t->folder);
    (void)snprintf(err, sizeof err, "%s/stderr", t->folder);
    (void)setrlimit(RLIMIT_FSIZE, &size);
    (void)setrlimit(RLIMIT_CORE, &core);
    (void)setrlimit(RLIMIT_CPU, &cpu); /* it would go round and round */
    if (chdir(t->source) == 0 && freopen("/dev/null", "r", stdin) && freopen(out, "w", stdout) &&
        freopen(err, "w", stderr))
        execv(words[0], words);
    _exit(127);
}

static double now_s(void)
{
    return (double)clock_now_ns() / 1e9;
}

/* A busy machine makes everything late: what counts is the lesser of both clocks. */
static double lesser(double a, double b)
{
    return a < b ? a : b;
}

static double used_s(const struct rusage *used)
{
    return (double)(used->ru_utime.tv_sec + used->ru_stime.tv_sec) +
           (double)(used->ru_utime.tv_usec + used->ru_stime.tv_usec) / 1e6;
}

static bool is_safe_to_print(const trial *t, const char *name)
{
    char path[PATH];
    size_t size;
    (void)snprintf(path, sizeof path, "%s/%s", t->folder, name);
    char *text = (char *)read_file(path, &size);
    for (size_t i = 0; i < size; ++i)
        if (text[i] == '\n')
            text[i] = ' ';
    bool good = text_is_printable(text_view_of(text ? text : "", size));
    free(text);
    return good;
}

static bool says(const trial *t, const char *words)
{
    char path[PATH];
    size_t size;
    (void)snprintf(path, sizeof path, "%s/stderr", t->folder);
    char *text = (char *)read_file(path, &size);
    bool found = text && strstr(text, words);
    free(text);
    return found;
}

/* stop_s: when SIGTERM is sent; < 0: never. */
static void run(trial *t, char *const *words, double stop_s)
{
    struct stat file;
    struct rusage used = {0};
    int status = 0;
    const double size = stat(t->show, &file) == 0 ? (double)file.st_size : 0.0;
    const double begun_s = now_s();
    double stopped_s = 0.0;
    bool is_killed = false;
    (void)fflush(NULL); /* the child would print it again */
    pid_t child = fork();
    must(child >= 0, "fork");
    if (child == 0)
        become(t, words);
    while (wait4(child, &status, WNOHANG, &used) == 0) {
        const double at_s = now_s() - begun_s;
        if (stop_s >= 0.0 && at_s >= stop_s && stopped_s <= 0.0) {
            (void)kill(child, SIGTERM);
            stopped_s = at_s;
        }
        if (at_s > WALL_MAX_S && !is_killed) {
            is_killed = true;
            (void)kill(child, SIGKILL);
        }
        clock_sleep_until_ns(clock_now_ns() + (int64_t)(poll_s * 1e9));
    }
    const double wall_s = now_s() - begun_s, took_s = lesser(wall_s, used_s(&used));
    const double room = bytes_per_byte * size + bytes_beside,
                 memory = (double)used.ru_maxrss * 1024.0;
    ++t->commands;
    t->refused += WIFEXITED(status) && WEXITSTATUS(status) != 0;
    if (took_s > t->longest_s) {
        t->longest_s = took_s;
        (void)snprintf(t->longest_what, sizeof t->longest_what, "%s %s, %.0f bytes", words[1],
                       words[2], size);
    }
    if (memory / room > t->largest_share)
        t->largest_share = memory / room;
    if (is_killed)
        report(t, "never ends", words);
    else if (WIFSIGNALED(status) && !(stop_s >= 0.0 && WTERMSIG(status) == SIGTERM))
        report(t, "ended by a signal", words);
    else if (says(t, "Sanitizer") || says(t, "runtime error") || says(t, "Assertion"))
        report(t, "a sanitizer found something", words);
    else if (took_s > limit_s)
        report(t, "takes too long", words);
    else if (memory > room)
        report(t, "takes too much memory", words);
    if (stopped_s > 0.0) {
        const double late_s = wall_s - stopped_s;
        ++t->stopped;
        if (late_s > t->longest_stop_s)
            t->longest_stop_s = late_s;
        if (late_s > stop_limit_s && lesser(late_s, used_s(&used)) > stop_limit_s)
            report(t, "goes on after SIGTERM", words);
    }
    if (!is_safe_to_print(t, "stdout") || !is_safe_to_print(t, "stderr"))
        report(t, "prints what steers a terminal", words);
    size_t victim_size;
    unsigned char *victim = read_file(t->victim, &victim_size);
    if (!victim || victim_size != 8 || memcmp(victim, "precious", 8) != 0) {
        report(t, "another file was touched", words);
        write_file(t->victim, "precious", 8);
    }
    free(victim);
}

/* ---- the commands; SHOW, OUT, FACE, DEMO stand for paths ---- */

static const char *const commands[] = {
    "take list SHOW",
    "take list SHOW --json",
    "take show SHOW 1",
    "take show SHOW last --json",
    "take show SHOW 2 --hash",
    "take check SHOW",
    "take pack SHOW",
    "take log SHOW 1 --track 1 --out OUT.csv",
    "take export SHOW 2 --export OUT.pc2",
    "take export SHOW 1 --export OUT.wav",
    "take diff SHOW 1 2",
    "take recover SHOW --out OUT.marotte",
    "take remap SHOW 1 --hand-length 180",
    "take note SHOW 1 text",
    "take trim SHOW 1 --in 0.1",
    "take layer_add SHOW 1 more",
    "take undo SHOW 1",
    "take keep SHOW",
    "perform --face FACE --map one_hand --input DEMO --record SHOW",
    "stage SHOW --hidden --seconds 0.5 --face FACE --settings=",
};
enum { COMMAND_COUNT = sizeof commands / sizeof commands[0], SLOW_COUNT = 2 };

static void command(trial *t, const char *of, double stop_s)
{
    char text[WORDS_MAX][PATH + 32];
    char *words[WORDS_MAX + 1] = {t->program};
    int count = 1;
    for (const char *at = of; *at && count < WORDS_MAX; at += strcspn(at, " "), at += *at == ' ') {
        const int length = (int)strcspn(at, " ");
        char *out = text[count];
        words[count++] = out;
        if (strncmp(at, "SHOW", 4) == 0)
            (void)snprintf(out, PATH + 32, "%s", t->show);
        else if (strncmp(at, "OUT", 3) == 0)
            (void)snprintf(out, PATH + 32, "%s/out/o%.*s", t->folder, length - 3, at + 3);
        else if (strncmp(at, "FACE", 4) == 0)
            (void)snprintf(out, PATH + 32, "%s", t->face);
        else if (strncmp(at, "DEMO", 4) == 0)
            (void)snprintf(out, PATH + 32, "log:%s", t->demo);
        else
            (void)snprintf(out, PATH + 32, "%.*s", length, at);
        for (char *c = out; strncmp(at, "layer_", 6) == 0 && *c; ++c)
            if (*c == '_') { /* a subcommand of two words */
                *c = '\0';
                (void)snprintf(text[count], PATH + 32, "%s", c + 1);
                words[count] = text[count];
                ++count;
                break;
            }
    }
    words[count] = NULL;
    run(t, words, stop_s);
}

static bool is_stage(const char *of)
{
    return strncmp(of, "stage", 5) == 0;
}

/* Those that change the show get it as it was. */
static void all_commands(trial *t)
{
    char copy[4 * PATH];
    for (int i = 0; i < COMMAND_COUNT; ++i) {
        if (i >= COMMAND_COUNT - SLOW_COUNT &&
            (!t->is_long || (is_stage(commands[i]) && !t->has_stage)))
            continue;
        (void)snprintf(copy, sizeof copy, "cp -a '%s' '%s.kept'", t->show, t->show);
        (void)!system(copy);
        command(t, commands[i], -1.0);
        (void)snprintf(copy, sizeof copy,
                       "mv -f '%s.kept' '%s'; rm -rf '%s-wal' '%s-shm' '%s/out'/*", t->show,
                       t->show, t->show, t->show, t->folder);
        (void)!system(copy);
    }
    ++t->files;
}

/* Slow ones now and then. */
static void some_commands(trial *t)
{
    for (int i = 0; i < 4; ++i) {
        uint64_t which = draw(t, COMMAND_COUNT);
        const bool is_slow = which >= COMMAND_COUNT - SLOW_COUNT;
        if (is_slow && (draw(t, 8) > 0 || (is_stage(commands[which]) && !t->has_stage)))
            which = draw(t, COMMAND_COUNT - SLOW_COUNT);
        const bool is_stopped = draw(t, 16) == 0;
        command(t, commands[which], is_stopped ? (double)draw(t, 200) / 1000.0 : -1.0);
    }
    ++t->files;
}

/* ---- shows that were found once ---- */

#define COUNT_TO(n)                                                                                \
    "WITH RECURSIVE n(i) AS (SELECT 100 UNION ALL SELECT i + 1 FROM n WHERE i < " n ")"
#define EVIL "char(27) || ']0;owned' || char(7) || char(10) || char(155) || char(8238)"

static const char *const known[] = {
    "UPDATE chunk SET bytes = CAST(bytes AS TEXT)",
    "UPDATE chunk SET from_ns = x''",
    "UPDATE take SET scene = " EVIL ", shot = " EVIL ", origin = " EVIL
    "; UPDATE track SET input = " EVIL ", device = " EVIL "; UPDATE event SET text = " EVIL
    "; UPDATE rig SET path = " EVIL "; UPDATE plugin SET identity = id || " EVIL,
    "UPDATE plugin SET identity = './x.so 1.0 ' || id",
    COUNT_TO("200000") " INSERT INTO take SELECT i, 0, 0, 1, 0, '', '', i, '', 0 FROM n",
    COUNT_TO("30000") " INSERT INTO performance_track SELECT 1, i, 1 FROM n;" COUNT_TO(
        "30000") " INSERT INTO span SELECT 1, i, 1, 1, 0, 0, NULL FROM n;"
                 "UPDATE take SET end_ns = NULL",
    COUNT_TO("30000") " INSERT INTO edit SELECT 1, 0, i, 0, 0, '{}' FROM n;"
                      "UPDATE take SET edit_head = 30000",
    COUNT_TO("150000") " INSERT INTO event SELECT i, i, 1, 1, 1, 0, 0, '' FROM n",
    COUNT_TO("50000") " INSERT INTO span SELECT 1, i, 1, 1, from_ns, from_ns + i, to_ns FROM n,"
                      " (SELECT from_ns, to_ns FROM span WHERE take = 1 LIMIT 1)",
    "CREATE TRIGGER evil AFTER INSERT ON session BEGIN DELETE FROM chunk; END",
    "ALTER TABLE take RENAME TO kept; CREATE VIEW take AS SELECT * FROM kept",
    "UPDATE track SET chunk_count = 9223372036854775807",
    "UPDATE take SET end_ns = 9223372036854775807, start_ns = -9223372036854775808",
    "UPDATE span SET to_ns = 9223372036854775807, from_ns = -9223372036854775808",
    "UPDATE performance SET to_ns = 9223372036854775807, from_ns = -9223372036854775808",
    "UPDATE checkpoint SET time_ns = -9223372036854775808",
    "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, 'bytes BLOB NOT "
    "NULL',"
    " 'bytes BLOB NOT NULL, evil AS (instr(zeroblob(100000000), zeroblob(50000000) || x''01''))')"
    " WHERE name = 'chunk'",
    "INSERT INTO audio VALUES(7, 'a', 0, 48000, 1, 's16');"
    " INSERT INTO audio_chunk VALUES(7, 7, 0, 9223372036854775807, 1, 0, x'0000')",
};

/* 49 states that unpack to 256 MB each: a run of zeros, packed, of the right CRC. */
static void add_bombs(trial *t)
{
    enum { PACKED_MAX = 1 << 20 };
    sqlite3 *db;
    sqlite3_stmt *insert;
    /* Fixed blocks of deflate: each of 8 bytes is no more than 258 zeros repeated; made by zlib. */
    char command_text[2 * PATH];
    char path[PATH];
    size_t size;
    (void)snprintf(path, sizeof path, "%s/bomb", t->folder);
    (void)snprintf(command_text, sizeof command_text,
                   "head -c 268435456 /dev/zero | gzip -9 -n > '%s'", path);
    if (system(command_text) != 0)
        return;
    unsigned char *gz = read_file(path, &size);
    if (size < 18 || size > PACKED_MAX) {
        free(gz);
        return;
    }
    /* gzip's head is 10 bytes, its end 8; zlib's are 2 and 4: Adler-32 of zeros */
    unsigned char *packed = malloc(size);
    must(packed != NULL, "memory");
    const size_t body = size - 18;
    const uint32_t adler = (uint32_t)(268435456 % 65521) << 16 | 1;
    packed[0] = 0x78, packed[1] = 0xda;
    memcpy(packed + 2, gz + 10, body);
    for (int i = 0; i < 4; ++i)
        packed[2 + body + (size_t)i] = (unsigned char)(adler >> (24 - 8 * i));
    uint32_t crc = 0xffffffffu;
    for (size_t i = 0; i < body + 6; ++i) {
        crc ^= packed[i];
        for (int bit = 0; bit < 8; ++bit)
            crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
    }
    crc = ~crc;
    must(sqlite3_open(t->show, &db) == SQLITE_OK, t->show);
    (void)sqlite3_exec(db, "BEGIN", NULL, NULL, NULL);
    (void)sqlite3_prepare_v2(db,
                             "INSERT INTO checkpoint SELECT 1000 + ?1, id, from_ns + ?1 * "
                             "100000000, 2, 268435456, ?2, ?3"
                             " FROM performance ORDER BY id LIMIT 1",
                             -1, &insert, NULL);
    for (int i = 0; i < 49; ++i) {
        (void)sqlite3_bind_int(insert, 1, i);
        (void)sqlite3_bind_int64(insert, 2, crc);
        (void)sqlite3_bind_blob(insert, 3, packed, (int)(body + 6), SQLITE_STATIC);
        (void)sqlite3_step(insert);
        (void)sqlite3_reset(insert);
    }
    (void)sqlite3_finalize(insert);
    (void)sqlite3_exec(db, "COMMIT", NULL, NULL, NULL);
    sqlite3_close(db);
    free(packed);
    free(gz);
    (void)unlink(path);
}

static void write_journal(const trial *t, const char *super)
{
    unsigned char bytes[512 + PATH + 20] = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};
    char path[PATH];
    size_t at = 512, length = strlen(super);
    uint32_t sum = 0;
    bytes[19] = 1, bytes[22] = 2, bytes[26] = 16;
    bytes[at + 3] = 2;
    memcpy(bytes + at + 4, super, length);
    for (size_t i = 0; i < length; ++i)
        sum += (unsigned char)super[i];
    at += 4 + length;
    for (size_t i = 0; i < 4; ++i) {
        bytes[at + i] = (unsigned char)(length >> (24 - 8 * i));
        bytes[at + 4 + i] = (unsigned char)(sum >> (24 - 8 * i));
    }
    memcpy(bytes + at + 8, bytes, 8);
    beside(t, "-journal", path);
    write_file(path, bytes, at + 16);
}

/* ---- shows by chance ---- */

static void change_bytes(trial *t)
{
    size_t size;
    unsigned char *bytes = read_file(t->show, &size);
    const uint64_t pages = size / PAGE;
    if (pages == 0) {
        free(bytes);
        return;
    }
    switch (draw(t, 4)) {
    case 0: /* bits anywhere */
        for (uint64_t i = draw(t, 60); i-- > 0;)
            bytes[draw(t, size)] ^= (unsigned char)(1u << draw(t, 8));
        break;
    case 1: /* a page instead of another: circles */
        for (uint64_t i = 1 + draw(t, 3); i-- > 0;)
            memmove(bytes + draw(t, pages) * PAGE, bytes + draw(t, pages) * PAGE, PAGE);
        break;
    case 2: /* numbers of pages in the heads and first cells of pages */
        for (uint64_t i = 1 + draw(t, 20); i-- > 0;) {
            unsigned char *page = bytes + draw(t, pages) * PAGE;
            page[8 + draw(t, 4)] = (unsigned char)draw(t, pages);
            page[draw(t, 12)] ^= (unsigned char)(1u << draw(t, 8));
        }
        break;
    default: /* it was cut */
        size = (size_t)draw(t, size);
        break;
    }
    write_file(t->show, bytes, size);
    free(bytes);
}

static void change_rows(trial *t)
{
    static const char *const values[] = {
        "NULL",
        "x''",
        "x'00ff'",
        "''",
        "'text'",
        EVIL,
        "0",
        "-1",
        "1",
        "9223372036854775807",
        "-9223372036854775808",
        "1e308",
        "-1e-308",
        "9e999",
        "zeroblob(100000)",
        "hex(zeroblob(20000))",
        "CAST(COL AS TEXT)",
        "CAST(COL AS BLOB)",
        "COL + 1",
        "COL * -1",
        "-COL",
        "(SELECT MAX(COL) FROM TABLE)",
        "abs(random())",
        "COL || COL",
    };
    enum { VALUES = sizeof values / sizeof values[0], NAMES = 200 };
    char table[NAMES][40], column[NAMES][40];
    int count = 0;
    sqlite3 *db;
    sqlite3_stmt *rows;
    if (sqlite3_open(t->show, &db) == SQLITE_OK &&
        sqlite3_prepare_v2(db,
                           "SELECT m.name, c.name FROM sqlite_schema m, pragma_table_info(m.name) c"
                           " WHERE m.type = 'table'",
                           -1, &rows, NULL) == SQLITE_OK) {
        while (count < NAMES && sqlite3_step(rows) == SQLITE_ROW) {
            (void)snprintf(table[count], 40, "%s", (const char *)sqlite3_column_text(rows, 0));
            (void)snprintf(column[count], 40, "%s", (const char *)sqlite3_column_text(rows, 1));
            ++count;
        }
        (void)sqlite3_finalize(rows);
    }
    for (uint64_t i = 1 + draw(t, 4); i-- > 0 && count > 0;) {
        const uint64_t at = draw(t, (uint64_t)count);
        char sql[400], value[200] = "";
        size_t used = 0;
        for (const char *c = values[draw(t, VALUES)]; *c && used < sizeof value - 48; ++c) {
            const bool is_column = strncmp(c, "COL", 3) == 0,
                       is_table = strncmp(c, "TABLE", 5) == 0;
            if (is_column || is_table) {
                used += (size_t)snprintf(value + used, sizeof value - used, "%s",
                                         is_column ? column[at] : table[at]);
                c += is_column ? 2 : 4;
            } else {
                value[used++] = *c;
                value[used] = '\0';
            }
        }
        static const char *const where[] = {"", "WHERE abs(random()) % 2",
                                            "WHERE abs(random()) % 9 = 0"};
        (void)snprintf(sql, sizeof sql, "UPDATE OR IGNORE %s SET %s = %s %s", table[at], column[at],
                       value, where[draw(t, 3)]);
        (void)sqlite3_exec(db, sql, NULL, NULL, NULL);
    }
    sqlite3_close(db);
}

static void put_beside(trial *t)
{
    static const char *const endings[] = {"-wal", "-shm", "-journal"};
    char path[PATH];
    unsigned char noise[8192];
    beside(t, endings[draw(t, 3)], path);
    (void)unlink(path);
    for (size_t i = 0; i < sizeof noise; ++i)
        noise[i] = (unsigned char)draw(t, 256);
    switch (draw(t, 4)) {
    case 0:
        (void)!symlink(t->victim, path);
        break;
    case 1:
        write_journal(t, t->victim);
        break;
    default:
        write_file(path, noise, (size_t)draw(t, sizeof noise));
    }
}

static void by_chance(trial *t)
{
    start_anew(t);
    const uint64_t kind = draw(t, 8);
    if (kind < 5)
        change_rows(t);
    if (kind > 3)
        change_bytes(t);
    if (draw(t, 6) == 0)
        put_beside(t);
    some_commands(t);
}

/* ---- the whole ---- */

static bool has_stage(trial *t)
{
    start_anew(t);
    const uint64_t before = t->failures;
    command(t, commands[COMMAND_COUNT - 1], -1.0);
    const bool works = t->failures == before && !says(t, "EGL") && !says(t, "OpenGL");
    t->failures = before;
    if (!works)
        printf("SKIPPED: the hidden stage, which needs OpenGL\n");
    return works;
}

static const char *setting(const char *name, const char *otherwise)
{
    const char *text = getenv(name);
    return text && text[0] ? text : otherwise;
}

static void prepare(trial *t)
{
    const char *temporary = setting("TMPDIR", access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
    (void)snprintf(t->folder, sizeof t->folder, "%s/marotte_hostile_XXXXXX", temporary);
    must(mkdtemp(t->folder) != NULL, t->folder);
    (void)snprintf(t->show, sizeof t->show, "%s/hostile.marotte", t->folder);
    (void)snprintf(t->victim, sizeof t->victim, "%s/victim", t->folder);
    (void)snprintf(t->findings, sizeof t->findings, "%s/hostile_shows", t->build);
    (void)snprintf(t->face, sizeof t->face, "%s/rigs/puppet/puppet.rig.json", t->source);
    (void)snprintf(t->demo, sizeof t->demo, "%s/plugins/log/demo_hand.csv", t->source);
    (void)setenv("XDG_CONFIG_HOME", t->folder, 1);
    (void)setenv("XDG_DATA_HOME", t->folder, 1);
    (void)setenv("XDG_DOCUMENTS_DIR", t->folder, 1);
}

int main(int argc, char **argv)
{
    trial *t = calloc(1, sizeof *t);
    must(t != NULL, "memory");
    const double seconds = argc > 1 ? atof(argv[1]) : 20.0;
    t->random = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    t->is_long = seconds >= 300.0;
    (void)snprintf(t->build, sizeof t->build, "%s", setting("BUILD_DIR", BUILD_DIR));
    (void)snprintf(t->source, sizeof t->source, "%s", setting("SOURCE_DIR", SOURCE_DIR));
    (void)snprintf(t->program, sizeof t->program, "%s", setting("MAROTTE", BUILD_DIR "/marotte"));
    if (access(t->program, X_OK) != 0) {
        printf("SKIPPED: %s is not built\n", t->program);
        return SKIPPED;
    }
    prepare(t);
    const double begun_s = now_s();
    t->has_stage = t->is_long && has_stage(t);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; ++i) {
        if (!t->is_long && now_s() - begun_s > seconds * 0.7)
            break; /* the order is that of how bad they were */
        start_anew(t);
        must(run_sql(t, known[i]), known[i]);
        all_commands(t);
    }
    start_anew(t);
    write_journal(t, t->victim);
    all_commands(t);
    if (t->is_long) {
        start_anew(t);
        add_bombs(t);
        all_commands(t);
    }
    while (now_s() - begun_s < seconds)
        by_chance(t);
    printf("%llu shows, %llu commands (%llu refused them, %llu were stopped): %llu failures; the "
           "longest took %.2f s (%s); the latest stop %.2f s; memory at most %.0f %% of what is "
           "allowed\n",
           (unsigned long long)t->files, (unsigned long long)t->commands,
           (unsigned long long)t->refused, (unsigned long long)t->stopped,
           (unsigned long long)t->failures, t->longest_s, t->longest_what, t->longest_stop_s,
           100.0 * t->largest_share);
    const bool failed = t->failures > 0;
    clear(t);
    char command_text[PATH];
    (void)snprintf(command_text, sizeof command_text, "rm -rf '%s'", t->folder);
    (void)!system(command_text);
    free(t);
    return failed;
}
