#include "check/child/trap.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/program.h"
#include "check/child/tell.h"

#include <execinfo.h>
#include <limits.h>
#include <link.h>
#include <marotte/plugin.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

/* ---- the place in the plugin ---- */

typedef ElfW(Ehdr) elf_header;
typedef ElfW(Shdr) elf_section;
typedef ElfW(Sym) elf_symbol;

enum { LIBRARY_SIZE_MAX = 256 << 20, SYMBOL_FUNCTION = 2 /* STT_FUNC */ };

static uintptr_t low, high; /* address range of the library */
static const char *library_name = "";
static file_bytes image;
static const elf_symbol *symbols;
static size_t symbol_count;
static const char *names;
static size_t names_size;

/* ---- the address range of the library ---- */

static void learn_mapping(const char *path)
{
    char line[PATH_MAX + 128];
    FILE *maps = fopen("/proc/self/maps", "r");
    if (!maps)
        return;
    while (fgets(line, sizeof line, maps)) {
        char *behind = NULL, *name = strchr(line, '/');
        line[strcspn(line, "\n")] = '\0';
        if (!name || strcmp(name, path) != 0)
            continue;
        uintptr_t from = (uintptr_t)strtoull(line, &behind, 16);
        uintptr_t to = *behind == '-' ? (uintptr_t)strtoull(behind + 1, NULL, 16) : from;
        if (low == 0 || from < low)
            low = from;
        if (to > high)
            high = to;
    }
    (void)fclose(maps);
}

/* ---- its symbols ---- */

static const void *piece(uint64_t offset, uint64_t size)
{
    return offset <= image.size && size <= image.size - offset ? image.data + offset : NULL;
}

/* Reads the symbols of a section, if they are complete. */
static bool read_symbols(const elf_section *sections, unsigned count, const elf_section *from)
{
    if (from->sh_link >= count)
        return false;
    const elf_section *strings = &sections[from->sh_link];
    const void *table = piece(from->sh_offset, from->sh_size);
    const void *text = piece(strings->sh_offset, strings->sh_size);
    if (!table || !text || from->sh_offset % _Alignof(elf_symbol) != 0 || strings->sh_size == 0)
        return false;
    symbols = table;
    symbol_count = from->sh_size / sizeof *symbols;
    names = text;
    names_size = strings->sh_size;
    return names[names_size - 1] == '\0';
}

static void learn_symbols(const char *path)
{
    error ignored;
    if (file_read(&image, path, LIBRARY_SIZE_MAX, &ignored) < 0)
        return;
    const elf_header *header = piece(0, sizeof *header);
    if (!header || header->e_shoff % _Alignof(elf_section) != 0)
        return;
    const elf_section *sections =
        piece(header->e_shoff, (uint64_t)header->e_shnum * sizeof *sections);
    static const uint32_t wanted[] = {SHT_SYMTAB, SHT_DYNSYM};
    for (size_t k = 0; sections && k < sizeof wanted / sizeof *wanted; ++k)
        for (unsigned i = 0; i < header->e_shnum; ++i)
            if (sections[i].sh_type == wanted[k] &&
                read_symbols(sections, header->e_shnum, &sections[i]))
                return;
    symbol_count = 0;
}

/* Copies the stack of the caller. Does not allocate after call_stack_set_library. */
static void call_stack_take(call_stack *out)
{
    out->count = backtrace(out->frame, CALL_STACK_FRAMES);
}

void call_stack_set_library(const char *library_path)
{
    static char path[PATH_MAX];
    if (!realpath(library_path, path))
        return;
    const char *slash = strrchr(path, '/');
    library_name = slash ? slash + 1 : path;
    learn_mapping(path);
    learn_symbols(path);
    call_stack first; /* the first call of backtrace() loads a library */
    call_stack_take(&first);
}

/* Returns whether the address is in the plugin. */
static bool is_inside_library(const void *address)
{
    return (uintptr_t)address >= low && (uintptr_t)address < high;
}

static const elf_symbol *find_symbol(uintptr_t offset)
{
    for (size_t i = 0; i < symbol_count; ++i) {
        const elf_symbol *s = &symbols[i];
        if ((s->st_info & 0xf) == SYMBOL_FUNCTION && s->st_name < names_size &&
            offset >= s->st_value && offset < s->st_value + s->st_size)
            return s;
    }
    return NULL;
}

/* Writes the innermost function of the plugin. Returns false and "an unknown place" if none is on
 * the stack. */
static bool call_stack_name(const call_stack *where, char *out, size_t capacity)
{
    for (int i = 0; i < where->count; ++i) {
        if (!is_inside_library(where->frame[i]))
            continue;
        uintptr_t offset = (uintptr_t)where->frame[i] - low;
        const elf_symbol *symbol = find_symbol(offset - 1); /* in the call */
        if (symbol)
            (void)snprintf(out, capacity, "%s+0x%zx (%s+0x%zx)", names + symbol->st_name,
                           (size_t)(offset - symbol->st_value), library_name, (size_t)offset);
        else
            (void)snprintf(out, capacity, "%s+0x%zx", library_name, (size_t)offset);
        return true;
    }
    (void)snprintf(out, capacity, "an unknown place");
    return false;
}

/* ---- forbidden calls ---- */

typedef struct trap_hit {
    const char *function; /* NULL: none */
    call_stack where;
} trap_hit;

static trap_hit hits[TRAP_KINDS];
static _Thread_local uint32_t trapped;

uint32_t trap_set(uint32_t kinds)
{
    uint32_t before = trapped;
    trapped = kinds;
    return before;
}

bool trap_catches(trap_kind kind)
{
    return trapped & (1u << kind);
}

void trap_note(trap_kind kind, const char *function)
{
    if (!trap_catches(kind) || hits[kind].function)
        return;
    uint32_t kinds = trap_set(0); /* reading the stack is not caused by the plugin */
    hits[kind].function = function;
    call_stack_take(&hits[kind].where);
    (void)trap_set(kinds);
}

bool trap_caught(trap_kind kind, char *out, size_t capacity)
{
    char where[256];
    if (!hits[kind].function)
        return false;
    (void)call_stack_name(&hits[kind].where, where, sizeof where);
    (void)snprintf(out, capacity, "%s() in %s", hits[kind].function, where);
    hits[kind].function = NULL;
    return true;
}

#if PROGRAM_IS_SANITIZED
size_t __sanitizer_get_current_allocated_bytes(void);
size_t trap_heap_bytes(void)
{
    return __sanitizer_get_current_allocated_bytes();
}
#else
size_t trap_heap_bytes(void)
{
    return (size_t)memory_in_use();
}
#endif

/* ---- calls that do not return ---- */

enum { STACK_BYTES = 1 << 16, TICKS_MAX = 20, FRAME_TICKS_MAX = 2 };
static const struct itimerval tick = {{0, 500000}, {0, 500000}}; /* of CPU time */

static unsigned char stack[STACK_BYTES];
static volatile sig_atomic_t is_over, is_in_frame, ticks;

/* Reports from a signal handler and ends the process. This is not async-signal-safe, but the
 * process is lost anyway, and the parent handles a child without a report. */
static void go_down(check_rule rule, const char *how)
{
    char where[256], text[512];
    call_stack at;
    (void)trap_set(0);
    call_stack_take(&at);
    (void)call_stack_name(&at, where, sizeof where);
    (void)snprintf(text, sizeof text, "%s in %s", how, where);
    is_over = 1;
    tell_down(rule, text);
    _exit(1);
}

static void on_crash(int signal_number)
{
    go_down(RULE_RUN_CRASH, strsignal(signal_number));
}

static void on_tick(int signal_number)
{
    (void)signal_number;
    ticks += 1;
    if (is_in_frame && ticks > FRAME_TICKS_MAX)
        go_down(RULE_RUN_HANG, "more than 1 s of processor time");
    if (ticks > TICKS_MAX)
        go_down(RULE_RUN_HANG, "more than 10 s of processor time");
}

static void on_alarm(int signal_number)
{
    (void)signal_number;
    go_down(RULE_RUN_HANG, "infinite loop");
}

static void on_exit_called(void)
{
    if (!is_over)
        go_down(RULE_RUN_EXIT, "the process exited");
}

/* Reports of a sanitizer end in on_crash. Without sanitizers these functions are not called. */
MRT_EXPORT const char *__asan_default_options(void);
MRT_EXPORT const char *__ubsan_default_options(void);

const char *__asan_default_options(void)
{
    return "abort_on_error=1";
}

const char *__ubsan_default_options(void)
{
    return "abort_on_error=1";
}

static void handle(int signal_number, void (*handler)(int))
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = handler;
    action.sa_flags = SA_ONSTACK | SA_RESTART;
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(signal_number, &action, NULL);
}

void watch_begin(unsigned limit_s)
{
    static const int crashes[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTRAP, SIGSYS};
    stack_t other = {.ss_sp = stack, .ss_size = sizeof stack};
    (void)sigaltstack(&other, NULL);
    for (size_t i = 0; i < sizeof crashes / sizeof *crashes; ++i)
        handle(crashes[i], on_crash);
    handle(SIGPROF, on_tick);
    handle(SIGALRM, on_alarm);
    (void)atexit(on_exit_called);
    (void)setitimer(ITIMER_PROF, &tick, NULL);
    (void)alarm(limit_s);
}

void watch_end(void)
{
    is_over = 1;
}

void watch_frame_enter(void)
{
    ticks = 0;
    is_in_frame = 1;
}

void watch_frame_leave(void)
{
    is_in_frame = 0;
    ticks = 0;
}

void watch_next(void)
{
    ticks = 0;
}
