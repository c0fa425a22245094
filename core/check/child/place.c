#include "check/child/place.h"
#include "base/file.h"

#include <execinfo.h>
#include <limits.h>
#include <link.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef ElfW(Ehdr) elf_header;
typedef ElfW(Shdr) elf_section;
typedef ElfW(Sym) elf_symbol;

enum { LIBRARY_SIZE_MAX = 256 << 20, SYMBOL_FUNCTION = 2 /* STT_FUNC */ };

static uintptr_t low, high; /* of the library in memory */
static const char *library_name = "";
static file_bytes image;
static const elf_symbol *symbols;
static size_t symbol_count;
static const char *names;
static size_t names_size;

/* ---- where it lies ---- */

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

/* The symbols of a section, if they are whole. */
static bool take_symbols(const elf_section *sections, unsigned count, const elf_section *from)
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
                take_symbols(sections, header->e_shnum, &sections[i]))
                return;
    symbol_count = 0;
}

void place_learn(const char *library_path)
{
    static char path[PATH_MAX];
    if (!realpath(library_path, path))
        return;
    const char *slash = strrchr(path, '/');
    library_name = slash ? slash + 1 : path;
    learn_mapping(path);
    learn_symbols(path);
    place first; /* the first call of backtrace() loads a library */
    place_take(&first);
}

void place_take(place *out)
{
    out->count = backtrace(out->frame, PLACE_FRAMES);
}

bool place_is_inside(const void *address)
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

bool place_name(const place *where, char *out, size_t capacity)
{
    for (int i = 0; i < where->count; ++i) {
        if (!place_is_inside(where->frame[i]))
            continue;
        uintptr_t offset = (uintptr_t)where->frame[i] - low;
        const elf_symbol *symbol = find_symbol(offset - 1); /* behind the call */
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
