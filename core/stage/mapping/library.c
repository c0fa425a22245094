#include "stage/mapping/library.h"

#include <dlfcn.h>
#include <limits.h>
#include <link.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

typedef ElfW(Ehdr) elf_header;
typedef ElfW(Phdr) elf_segment;

static bool is_native_elf(const elf_header *header)
{
    unsigned char native = sizeof(void *) == 8 ? ELFCLASS64 : ELFCLASS32;
    return memcmp(header->e_ident, ELFMAG, SELFMAG) == 0 && header->e_ident[EI_CLASS] == native &&
           header->e_phentsize == sizeof(elf_segment);
}

static bool lies_within(uint64_t offset, uint64_t length, uint64_t size)
{
    return length <= size && offset <= size - length;
}

static mrt_result cut_short(uint64_t size, error *err)
{
    return error_set(err, MRT_ERR_FORMAT, "is cut short at %ju bytes: copy or build it again",
                     (uintmax_t)size);
}

static mrt_result check_segments(FILE *file, uint64_t size, error *err)
{
    elf_header header;
    if (fread(&header, sizeof header, 1, file) != 1 || !is_native_elf(&header))
        return MRT_OK;
    uint64_t table_size = (uint64_t)header.e_phnum * sizeof(elf_segment);
    if (!lies_within(header.e_phoff, table_size, size) ||
        fseek(file, (long)header.e_phoff, SEEK_SET) != 0)
        return cut_short(size, err);
    for (unsigned i = 0; i < header.e_phnum; ++i) {
        elf_segment segment;
        if (fread(&segment, sizeof segment, 1, file) != 1)
            return cut_short(size, err);
        if (segment.p_type == PT_LOAD && !lies_within(segment.p_offset, segment.p_filesz, size))
            return cut_short(size, err);
    }
    return MRT_OK;
}

mrt_result library_check_file(const char *path, error *err)
{
    struct stat status;
    if (stat(path, &status) != 0)
        return MRT_OK;
    if (!S_ISREG(status.st_mode))
        return error_set(err, MRT_ERR_FORMAT, "is no regular file");
    FILE *file = fopen(path, "rb");
    if (!file)
        return MRT_OK;
    mrt_result result = check_segments(file, (uint64_t)status.st_size, err);
    (void)fclose(file);
    return result;
}

/* A name without a slash would be looked for in the system's folders. */
static bool as_path(char out[PATH_MAX], const char *path)
{
    int length = snprintf(out, PATH_MAX, "%s%s", strchr(path, '/') ? "" : "./", path);
    return length > 0 && length < PATH_MAX;
}

const mrt_plugin_type *const *library_open(const char *path, error *err)
{
    char name[PATH_MAX];
    if (!as_path(name, path)) {
        (void)error_set(err, MRT_ERR_ARGUMENT, "has too long a name");
        return NULL;
    }
    if (library_check_file(name, err) < 0)
        return NULL;
    dlerror();
    void *library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char *reason = dlerror();
        (void)error_set(err, MRT_ERR_FORMAT, "%s", reason ? reason : "cannot be loaded");
        return NULL;
    }
    const mrt_plugin_type *const *types = dlsym(library, "marotte_plugins");
    if (types && types[0])
        return types;
    (void)error_set(err, MRT_ERR_FORMAT,
                    types ? "its marotte_plugins is empty"
                          : "has no symbol marotte_plugins: not a marotte plugin");
    return NULL;
}
