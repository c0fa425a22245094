#include "io/read/mtl.h"

#include "base/budget.h"
#include "base/file.h"
#include "io/read/mesh_build.h"
#include "io/read/mesh_images.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const size_t FILE_SIZE_MAX = (size_t)16 << 20; /* bytes */

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the materials");
}

/* ---- names of files ---- */

/* Simplifies a path in place: "mat/../tex" becomes "tex". */
static void straighten(char *path)
{
    for (char *up = strstr(path, "/../"); up; up = strstr(path, "/../")) {
        char *before = up;
        while (before > path && before[-1] != '/')
            before -= 1;
        if (before == up || strncmp(before, "../", 3) == 0)
            return; /* above the start folder */
        memmove(before, up + 4, strlen(up + 4) + 1);
    }
}

/* Resolves a file name, also with backslashes: "textures\skin.png". An absolute path of another
 * computer, "C:\work\skin.png" or "/home/her/skin.png", becomes "skin.png", which may be beside the
 * OBJ. Returns false if it cannot be a file name. */
static bool resolve(char out[PATH_MAX], const char *folder, text_view name)
{
    size_t begin = strlen(folder), length = (size_t)(name.end - name.at);
    if (length == 0 || begin + length >= PATH_MAX || memchr(name.at, '\0', length))
        return false;
    memcpy(out, folder, begin);
    memcpy(out + begin, name.at, length);
    out[begin + length] = '\0';
    char *own = out + begin;
    for (char *c = own; *c; ++c)
        *c = *c == '\\' ? '/' : *c;
    bool is_elsewhere = own[0] == '/' || (length > 2 && own[1] == ':' && own[2] == '/');
    char *last = is_elsewhere ? strrchr(own, '/') + 1 : own;
    if (strncmp(last, "./", 2) == 0)
        last += 2;
    memmove(own, last, strlen(last) + 1);
    bool is_name = *own != '\0';
    straighten(out);
    return is_name && *out != '\0';
}

/* ---- statements ---- */

static bool is_keyword(text_view word, const char *keyword)
{
    size_t length = strlen(keyword);
    return (size_t)(word.end - word.at) == length && strncasecmp(word.at, keyword, length) == 0;
}

static float within(float number, float low, float high)
{
    return number > low ? (number < high ? number : high) : low;
}

/* Reads "r g b", or "r" as grey. */
static bool read_colour(float out[3], text_view rest, float most)
{
    float number[3];
    int count = 0;
    text_view word;
    while (count < 3 && text_next_word(&rest, &word)) {
        if (!text_float(word, &number[count]))
            return false;
        count += 1;
    }
    for (int i = 0; i < 3; ++i)
        out[i] = within(number[count == 3 ? i : 0], 0.0f, most);
    return count == 1 || count == 3;
}

static bool read_opacity(mtl_material *m, text_view rest)
{
    float number;
    text_view word;
    if (!text_next_word(&rest, &word) ||
        (text_equals(word, "-halo") && !text_next_word(&rest, &word)) || !text_float(word, &number))
        return false;
    m->look.base_colour[3] = within(number, 0.0f, 1.0f);
    m->says_opacity = true;
    return true;
}

/* Reads Tr, which is 1 - d. A fully transparent material comes from a program that writes d as Tr.
 * */
static bool read_transparency(mtl_material *m, text_view rest)
{
    float number;
    text_view word;
    if (!text_next_word(&rest, &word) || !text_float(word, &number))
        return false;
    if (!m->says_opacity)
        m->look.base_colour[3] = number < 1.0f ? 1.0f - within(number, 0.0f, 1.0f) : 1.0f;
    return true;
}

/* ---- pictures and their options ---- */

/* Reads up to `most` numbers; missing numbers keep their value. */
static bool read_numbers(float *out, int most, text_view *rest)
{
    int count = 0;
    for (text_view after = *rest, word; count < most && text_next_word(&after, &word); ++count) {
        if (!text_float(word, &out[count]))
            break;
        *rest = after;
    }
    return count > 0;
}

static void uv_transform(mesh_texture *out, const float scale[3], const float shift[3])
{
    const float of_glTF[6] = {scale[0], 0.0f, shift[0], 0.0f, scale[1], 1.0f - scale[1] - shift[1]};
    for (int i = 0; i < 6; ++i)
        out->uv_transform[i] = within(of_glTF[i], -1e6f, 1e6f);
}

/* Reads an option of a picture; unused ones are skipped with their arguments. Returns false if it
 * is unknown or invalid. */
static bool read_option(mtl_map *map, float scale[3], float shift[3], text_view option,
                        text_view *rest)
{
    static const struct {
        const char *name;
        int words;
    } passed_over[] = {{"-blendu", 1}, {"-blendv", 1}, {"-cc", 1},     {"-imfchan", 1},
                       {"-type", 1},   {"-boost", 1},  {"-texres", 1}, {"-mm", 2}};
    text_view word;
    float ignored[3];
    if (text_equals(option, "-s"))
        return read_numbers(scale, 3, rest);
    if (text_equals(option, "-o"))
        return read_numbers(shift, 3, rest);
    if (text_equals(option, "-t"))
        return read_numbers(ignored, 3, rest);
    if (text_equals(option, "-bm"))
        return read_numbers(&map->amount, 1, rest);
    if (text_equals(option, "-clamp")) {
        if (!text_next_word(rest, &word))
            return false;
        map->placed.wrap[0] = map->placed.wrap[1] =
            text_equals(word, "on") ? MESH_WRAP_CLAMP : MESH_WRAP_REPEAT;
        return true;
    }
    for (size_t i = 0; i < sizeof passed_over / sizeof *passed_over; ++i)
        if (text_equals(option, passed_over[i].name)) {
            for (int k = 0; k < passed_over[i].words; ++k)
                if (!text_next_word(rest, &word))
                    return false;
            return true;
        }
    return false;
}

static mrt_result read_map(mtl_map *map, bool *out_good, text_view rest, const char *folder,
                           error *err)
{
    char path[PATH_MAX];
    float scale[3] = {1.0f, 1.0f, 1.0f}, shift[3] = {0.0f, 0.0f, 0.0f};
    free(map->file);
    *map = (mtl_map){.amount = 1.0f};
    rest = text_trim(rest);
    for (text_view after = rest, word; text_next_word(&after, &word); after = rest) {
        if (*word.at != '-' || !read_option(map, scale, shift, word, &after))
            break;
        rest = text_trim(after);
    }
    uv_transform(&map->placed, scale, shift);
    *out_good = resolve(path, folder, rest);
    if (*out_good && !(map->file = strdup(path)))
        return no_memory(err);
    return MRT_OK;
}

/* ---- a file of materials ---- */

static mrt_result add_material(mtl_library *library, text_view name, error *err)
{
    char clean[MESH_BUILD_NAME_LENGTH_MAX + 1];
    if (library->count == MESH_BUILD_NAMES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "at most %d materials are allowed",
                         MESH_BUILD_NAMES_MAX);
    mrt_result result = mesh_build_grow((void **)&library->material, &library->capacity,
                                        library->count + 1, sizeof *library->material, err);
    if (result < 0)
        return result;
    text_copy(clean, sizeof clean, name);
    mtl_material *m = &library->material[library->count];
    *m = (mtl_material){
        .name = strdup(clean), .look = mesh_material_grey(), .order = library->count};
    if (!m->name)
        return no_memory(err);
    library->count += 1;
    return MRT_OK;
}

static mrt_result read_statement(mtl_material *m, bool *out_good, text_view keyword, text_view rest,
                                 const char *folder, error *err)
{
    static const struct {
        const char *keyword;
        mtl_use use;
    } maps[] = {
        {"map_Kd", MTL_BASE}, {"map_d", MTL_CLEAR}, {"map_Ke", MTL_EMISSION}, {"norm", MTL_NORMAL}};
    *out_good = true;
    if (is_keyword(keyword, "Kd"))
        *out_good = read_colour(m->look.base_colour, rest, 1.0f);
    else if (is_keyword(keyword, "Ke"))
        *out_good = read_colour(m->look.emission_colour, rest, 100.0f);
    else if (is_keyword(keyword, "d"))
        *out_good = read_opacity(m, rest);
    else if (is_keyword(keyword, "Tr"))
        *out_good = read_transparency(m, rest);
    for (size_t i = 0; i < sizeof maps / sizeof *maps; ++i)
        if (is_keyword(keyword, maps[i].keyword))
            return read_map(&m->map[maps[i].use], out_good, rest, folder, err);
    return MRT_OK;
}

mrt_result mtl_parse(mtl_library *library, const void *data, size_t size, const char *folder,
                     error *err)
{
    text_view rest = text_view_of(data, size), line, keyword;
    const size_t first = library->count;
    mrt_result result = MRT_OK;
    for (uint64_t number = 1; result >= 0 && text_next_line(&rest, &line); ++number) {
        bool is_good = true;
        if (!text_next_word(&line, &keyword) || *keyword.at == '#')
            continue;
        if (is_keyword(keyword, "newmtl"))
            result = add_material(library, text_trim(line), err);
        else if (library->count > first)
            result = read_statement(&library->material[library->count - 1], &is_good, keyword, line,
                                    folder, err);
        if (!is_good && library->malformed_count++ == 0)
            library->malformed_line = number;
    }
    return result;
}

static bool is_known(const mtl_library *library, const char *name)
{
    for (uint32_t i = 0; i < library->file_count; ++i)
        if (strcmp(library->file[i], name) == 0)
            return true;
    return false;
}

static mrt_result read_one(mtl_library *library, text_view name, const char *directory, error *err)
{
    char path[PATH_MAX];
    file_bytes bytes;
    if (!resolve(path, "", name))
        return error_set(err, MRT_ERR_FORMAT, "that is not a file name");
    if (is_known(library, path))
        return MRT_OK;
    if (library->file_count == MTL_FILES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "at most %d material files are read",
                         MTL_FILES_MAX);
    mrt_result result = file_read_below(&bytes, directory, path, FILE_SIZE_MAX, err);
    if (result < 0)
        return result;
    char *folder = file_directory(path), *copy = strdup(path);
    result =
        folder && copy ? mtl_parse(library, bytes.data, bytes.size, folder, err) : no_memory(err);
    file_bytes_finish(&bytes);
    free(folder);
    if (result < 0)
        free(copy);
    else
        library->file[library->file_count++] = copy;
    return result;
}

/* Reads one name with spaces in it, or several names. */
mrt_result mtl_read(mtl_library *library, text_view names, const char *directory, error *err)
{
    text_view word;
    names = text_trim(names);
    mrt_result result = read_one(library, names, directory, err);
    if (result >= 0 || result == MRT_ERR_MEMORY)
        return result;
    for (text_view rest = names; text_next_word(&rest, &word);) {
        error own = {""};
        if (word.end == names.end && word.at == names.at)
            return result;
        mrt_result one = read_one(library, word, directory, &own);
        if (one == MRT_ERR_MEMORY)
            return error_set(err, one, "%s", own.text);
        result = one >= 0 ? one : result;
    }
    return result;
}

void mtl_library_finish(mtl_library *library)
{
    for (size_t i = 0; i < library->count; ++i) {
        free(library->material[i].name);
        for (int use = 0; use < MTL_USES; ++use)
            free(library->material[i].map[use].file);
    }
    for (uint32_t i = 0; i < library->file_count; ++i)
        free(library->file[i]);
    free(library->material);
    *library = (mtl_library){0};
}

/* ---- applying materials to a mesh ---- */

enum { TRIED_MAX = 64 };

typedef struct applying {
    mesh *m;
    const char *directory;
    budget bytes;
    const char *tried[TRIED_MAX]; /* files */
    uint32_t image[TRIED_MAX];    /* per material: 1 + index of its picture; 0: not drawn */
    uint32_t tried_count;
    bool is_full;
} applying;

static mrt_result add_picture(applying *a, uint32_t *out_image, const char *file, error *err)
{
    file_bytes bytes;
    mrt_result result = mesh_image_room(a->m, err);
    if (result >= 0)
        result = file_read_below(&bytes, a->directory, file, MESH_IMAGE_SIZE_MAX, err);
    if (result < 0)
        return result;
    result = mesh_image_add(a->m, out_image, file, bytes.data, bytes.size, &a->bytes, err);
    file_bytes_finish(&bytes);
    return result;
}

/* Returns 1 + the index of a picture; 0: not drawn. */
static uint32_t picture(applying *a, const char *file)
{
    uint32_t image = 0;
    error why = {""};
    for (uint32_t i = 0; i < a->tried_count; ++i)
        if (strcmp(a->tried[i], file) == 0)
            return a->image[i];
    if (a->tried_count == TRIED_MAX) {
        if (!a->is_full)
            mesh_note(a->m, "only the first %d of its pictures are drawn", TRIED_MAX);
        a->is_full = true;
        return 0;
    }
    if (add_picture(a, &image, file, &why) < 0)
        mesh_image_note(a->m, file, why.text);
    a->tried[a->tried_count] = file;
    a->image[a->tried_count++] = image;
    return image;
}

static mesh_texture texture_of(applying *a, const mtl_map *map)
{
    mesh_texture out = map->placed;
    out.image = picture(a, map->file);
    return out.image ? out : mesh_material_grey().base;
}

/* Adds the pictures. A picture is not tinted, because programs write any colour beside it. A
 * picture with its own alpha is drawn as a cutout instead of blended, so it needs no sorting. */
static void add_maps(applying *a, mesh_material *look, const mtl_material *from)
{
    const mtl_map *base = &from->map[MTL_BASE], *clear = &from->map[MTL_CLEAR];
    const mtl_map *glow = &from->map[MTL_EMISSION], *normal = &from->map[MTL_NORMAL];
    if (base->file)
        look->base = texture_of(a, base);
    if (look->base.image)
        look->base_colour[0] = look->base_colour[1] = look->base_colour[2] = 1.0f;
    if (clear->file && base->file && strcmp(clear->file, base->file) == 0) {
        look->alpha = look->base.image ? MESH_ALPHA_MASK : MESH_ALPHA_OPAQUE;
        look->base_colour[3] = 1.0f;
    } else if (clear->file) {
        mesh_image_note(a->m, clear->file, "transparency must be in a separate picture");
    }
    if (glow->file)
        look->emission = texture_of(a, glow);
    for (int i = 0; look->emission.image && i < 3; ++i)
        look->emission_colour[i] =
            look->emission_colour[i] > 0.0f ? look->emission_colour[i] : 1.0f;
    if (normal->file)
        look->normal = texture_of(a, normal);
    look->normal_scale = within(normal->file ? normal->amount : 1.0f, -10.0f, 10.0f);
}

static void give_look(applying *a, mesh_material *to, const mtl_material *from)
{
    char *name = to->name;
    *to = from->look;
    to->name = name;
    if (to->base_colour[3] < 1.0f)
        to->alpha = MESH_ALPHA_BLEND;
    if (a->m->uv)
        add_maps(a, to, from);
}

static int by_name(const void *left, const void *right)
{
    const mtl_material *p = left, *q = right;
    int names = strcmp(p->name, q->name);
    return names ? names : (p->order > q->order) - (p->order < q->order);
}

/* Finds the last material of a name; NULL: not found. */
static const mtl_material *find(const mtl_library *library, const char *name)
{
    size_t low = 0, high = library->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (strcmp(library->material[middle].name, name) <= 0)
            low = middle + 1;
        else
            high = middle;
    }
    const mtl_material *found = low > 0 ? &library->material[low - 1] : NULL;
    return found && strcmp(found->name, name) == 0 ? found : NULL;
}

uint32_t mtl_apply(mesh *m, mtl_library *library, const char *directory, size_t obj_size)
{
    applying a = {
        .m = m, .directory = directory, .bytes = budget_of(BUDGET_IMAGE, (uint64_t)obj_size)};
    uint32_t missing = 0, first_missing = 0, without_uv = 0;
    if (library->count)
        qsort(library->material, library->count, sizeof *library->material, by_name);
    for (uint32_t i = 0; i < m->material_count; ++i) {
        const mtl_material *from = find(library, m->material[i].name);
        if (from) {
            give_look(&a, &m->material[i], from);
            without_uv += !m->uv && from->map[MTL_BASE].file;
        } else if (library->file_count && m->material[i].name[0] && missing++ == 0) {
            first_missing = i;
        }
    }
    if (missing)
        mesh_note(m,
                  "%u of its materials are not in any material file, the first is \"%s\": they "
                  "are grey",
                  missing, m->material[first_missing].name);
    if (library->malformed_count)
        mesh_note(m,
                  "%zu lines of its materials are invalid and were skipped, the first is "
                  "line %llu",
                  library->malformed_count, (unsigned long long)library->malformed_line);
    return without_uv;
}
