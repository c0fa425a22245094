#include "show/pack.h"

#include "base/os.h"
#include "base/file.h"
#include "base/text.h"
#include "io/mesh_file.h"
#include "show/hash.h"

#include <jansson.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { LIST_BYTES_MAX = 1 << 20, KEY = 40 };
static const char list_name[] = "files.json"; /* list of the files of a face, with their SHA-256 */

typedef struct file_list {
    char *
        name[PACK_FILES_MAX]; /* paths below the folder of the face; the first is the face; owned */
    char hash[PACK_FILES_MAX][TAKE_HASH];
    uint32_t count;
} file_list;

static void list_finish(file_list *list)
{
    for (uint32_t i = 0; list && i < list->count; ++i)
        free(list->name[i]);
    free(list);
}

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the files of a face");
}

/* Checks that a name stays below its folder: components separated by '/', none hidden, none "..".
 * */
static bool is_safe_name(const char *name)
{
    size_t length = strlen(name);
    if (length == 0 || length > 512 || !text_is_printable(text_view_of(name, length)) ||
        strchr(name, '\\'))
        return false;
    for (const char *word = name; word; word = strchr(word, '/') ? strchr(word, '/') + 1 : NULL)
        if (*word == '/' || *word == '.' || *word == '\0')
            return false;
    return true;
}

/* ---- paths ---- */

static mrt_result join(char out[PATH_MAX], const char *folder, const char *name, error *err)
{
    int length = snprintf(out, PATH_MAX, "%s%s", folder, name);
    return length > 0 && length < PATH_MAX
               ? MRT_OK
               : error_set(err, MRT_ERR_ARGUMENT, "%.200s...: the path is too long", folder);
}

static mrt_result pack_folder(char out[PATH_MAX], const char *show_path, error *err)
{
    static const char ending[] = ".marotte";
    size_t length = strlen(show_path), cut = sizeof ending - 1;
    bool is_usual = length > cut && strcmp(show_path + length - cut, ending) == 0;
    int written =
        snprintf(out, PATH_MAX, "%.*s.pack/", (int)(is_usual ? length - cut : length), show_path);
    return written > 0 && written < PATH_MAX - 128
               ? MRT_OK
               : error_set(err, MRT_ERR_ARGUMENT, "%.200s...: the path is too long", show_path);
}

/* Returns true for a real folder, not for a link. `folder` ends in '/'. */
static bool is_folder(const char *folder)
{
    struct stat status;
    char path[PATH_MAX];
    (void)snprintf(path, sizeof path, "%.*s", (int)(strlen(folder) - 1), folder);
    return os_stat_link(path, &status) == 0 && S_ISDIR(status.st_mode);
}

static bool is_hash(const char *text)
{
    return strlen(text) == TAKE_HASH - 1 && strspn(text, "0123456789abcdef") == TAKE_HASH - 1;
}

/* Returns the folder of the face. A performance is untrusted data, so its hashes may be any text.
 * */
static mrt_result face_folder(char out[PATH_MAX], const char *pack, const take_performance *p,
                              error *err)
{
    char key[KEY];
    if (!is_hash(p->mesh_hash) || (p->rig_hash[0] && !is_hash(p->rig_hash)))
        return error_set(err, MRT_ERR_FORMAT, "the show does not name the face");
    (void)snprintf(key, sizeof key, "%.16s-%.16s/", p->rig_hash[0] ? p->rig_hash : "mesh",
                   p->mesh_hash);
    return join(out, pack, key, err);
}

/* Returns the name of the face in the pack. Only its file type comes from the show. */
static mrt_result face_name(char out[32], const take_performance *p, error *err)
{
    file_extension extension = file_extension_of(p->rig);
    if (p->rig_hash[0]) {
        (void)snprintf(out, 32, "face.rig.json");
        return MRT_OK;
    }
    if (!extension.text[0] ||
        strspn(extension.text, "abcdefghijklmnopqrstuvwxyz0123456789") != strlen(extension.text))
        return error_set(err, MRT_ERR_FORMAT, "%s: is not a mesh file", p->rig);
    (void)snprintf(out, 32, "face.%s", extension.text);
    return MRT_OK;
}

/* ---- reading and checking ---- */

static mrt_result check_file(const char *folder, const char *name, const char *hash, error *err)
{
    char path[PATH_MAX], now[TAKE_HASH];
    struct stat status;
    if (!is_safe_name(name))
        return error_set(err, MRT_ERR_FORMAT, "%s: names \"%.80s\", which is not one of its files",
                         folder, name);
    mrt_result result = join(path, folder, name, err);
    for (char *at = path + strlen(folder); result >= 0 && (at = strchr(at, '/')); *at++ = '/') {
        *at = '\0';
        if (os_stat_link(path, &status) != 0 || !S_ISDIR(status.st_mode))
            result = error_set(err, MRT_ERR_FORMAT, "%s: is not a folder", path);
    }
    if (result >= 0 && os_stat_link(path, &status) != 0)
        result = error_set(err, MRT_ERR_IO, "%s: %s", path, strerror(errno));
    if (result >= 0 && (!S_ISREG(status.st_mode) || status.st_size > PACK_BYTES_MAX))
        result = error_set(err, MRT_ERR_FORMAT, "%s: is not a regular file, or too large", path);
    if (result >= 0)
        result = hash_file(now, path, err);
    if (result >= 0 && strcmp(now, hash) != 0)
        result = error_set(err, MRT_ERR_FORMAT, "%s: differs from the packed file", path);
    return result;
}

static mrt_result read_list(file_list **out, const char *folder, error *err)
{
    char path[PATH_MAX];
    file_bytes bytes;
    struct stat status;
    *out = calloc(1, sizeof **out);
    if (!*out)
        return no_memory(err);
    mrt_result result = join(path, folder, list_name, err);
    if (result >= 0 && (os_stat_link(path, &status) != 0 || !S_ISREG(status.st_mode)))
        result = error_set(err, MRT_ERR_FORMAT, "%s: is no file", path);
    if (result >= 0)
        result = file_read(&bytes, path, LIST_BYTES_MAX, err);
    if (result < 0)
        return result;
    json_t *root = json_loadb((const char *)bytes.data, bytes.size, JSON_REJECT_DUPLICATES, NULL);
    file_bytes_finish(&bytes);
    const char *name;
    json_t *value, *files = json_object_get(root, "files");
    bool is_good = json_integer_value(json_object_get(root, "marotte_pack")) == 1 &&
                   json_object_size(files) > 0 && json_object_size(files) <= PACK_FILES_MAX;
    json_object_foreach(files, name, value)
    {
        is_good = is_good && is_safe_name(name) && json_is_string(value) &&
                  is_hash(json_string_value(value));
        if (!is_good)
            break;
        (*out)->name[(*out)->count] = strdup(name);
        memcpy((*out)->hash[(*out)->count], json_string_value(value), TAKE_HASH);
        is_good = (*out)->name[(*out)->count] != NULL;
        (*out)->count += is_good ? 1 : 0;
    }
    json_decref(root);
    return is_good ? MRT_OK
                   : error_set(err, MRT_ERR_FORMAT, "%s: is not the file list of a pack", path);
}

/* Checks that the list has the face, and that all listed files are unchanged. */
static mrt_result check_face(char out_face[PATH_MAX], const char *folder, const take_performance *p,
                             error *err)
{
    char name[32];
    file_list *list = NULL;
    bool is_listed = false;
    mrt_result result = face_name(name, p, err);
    if (result >= 0)
        result = read_list(&list, folder, err);
    for (uint32_t i = 0; result >= 0 && i < list->count; ++i) {
        const char *expected = p->rig_hash[0] ? p->rig_hash : p->mesh_hash;
        bool is_face = strcmp(list->name[i], name) == 0;
        is_listed |= is_face;
        result = check_file(folder, list->name[i], is_face ? expected : list->hash[i], err);
    }
    list_finish(list);
    if (result >= 0 && !is_listed)
        result = error_set(err, MRT_ERR_FORMAT, "%s: has no %s", folder, name);
    return result < 0 ? result : join(out_face, folder, name, err);
}

mrt_result pack_find(char out_face[PATH_MAX], const char *show_path, const take_performance *p,
                     error *err)
{
    char pack[PATH_MAX], folder[PATH_MAX];
    struct stat status;
    mrt_result result = pack_folder(pack, show_path, err);
    if (result < 0)
        return result;
    pack[strlen(pack) - 1] = '\0';
    if (os_stat_link(pack, &status) != 0 && errno == ENOENT)
        return MRT_END;
    pack[strlen(pack)] = '/';
    if (!is_folder(pack))
        return error_set(err, MRT_ERR_FORMAT, "%s: is not a folder: links are not followed", pack);
    result = face_folder(folder, pack, p, err);
    if (result >= 0 && !is_folder(folder))
        result = error_set(err, MRT_ERR_IO,
                           "%s: does not have the performed face (%s): choose one with --face FILE",
                           pack, p->rig);
    return result < 0 ? result : check_face(out_face, folder, p, err);
}

/* ---- the files of a face ---- */

typedef struct gathering {
    char folder[PATH_MAX]; /* folder of the face, ends in '/' */
    file_list *list;
} gathering;

static mrt_result gather(gathering *self, const char *name, error *err);

/* Decodes "a%20b" of a URI in place. */
static void decode_uri(char *text)
{
    char *to = text;
    for (const char *at = text; *at; ++to) {
        unsigned value;
        bool is_coded = at[0] == '%' && at[1] && at[2] && sscanf(at + 1, "%2x", &value) == 1;
        *to = is_coded ? (char)value : *at;
        at += is_coded ? 3 : 1;
    }
    *to = '\0';
}

/* Adds a file that another file names, relative to the folder of that file. NULL: no name. */
static mrt_result gather_named(gathering *self, const char *by, const char *text, bool is_uri,
                               error *err)
{
    char name[PATH_MAX];
    const char *slash = strrchr(by, '/');
    if (!text || (is_uri && strncmp(text, "data:", 5) == 0))
        return MRT_OK;
    int length = snprintf(name, sizeof name, "%.*s", slash ? (int)(slash + 1 - by) : 0, by);
    char *end = name + length;
    if (snprintf(end, sizeof name - (size_t)length, "%s",
                 strncmp(text, "./", 2) ? text : text + 2) >= (int)sizeof name - length)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: names a path that is too long", by);
    if (is_uri)
        decode_uri(end);
    if (end[0] == '/' || !is_safe_name(name))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s%s: names \"%.120s\": only files in or below the folder of the face "
                         "can be packed; move it there and use its new name",
                         self->folder, by, text);
    return gather(self, name, err);
}

static mrt_result gather_uris(gathering *self, const char *by, const json_t *list, error *err)
{
    mrt_result result = MRT_OK;
    for (size_t i = 0; i < json_array_size(list) && result >= 0; ++i)
        result = gather_named(self, by,
                              json_string_value(json_object_get(json_array_get(list, i), "uri")),
                              true, err);
    return result;
}

/* Reads the JSON of a rig or a glTF. A binary glTF has a 12-byte header, then the JSON in its first
 * chunk. */
static mrt_result gather_document(gathering *self, const char *name, const char *path, error *err)
{
    file_bytes bytes;
    mrt_result result = file_read(&bytes, path, PACK_BYTES_MAX, err);
    if (result < 0)
        return result;
    const char *text = (const char *)bytes.data;
    size_t size = bytes.size;
    if (size > 20 && memcmp(text, "glTF", 4) == 0) {
        uint32_t chunk = (uint32_t)bytes.data[12] | (uint32_t)bytes.data[13] << 8 |
                         (uint32_t)bytes.data[14] << 16 | (uint32_t)bytes.data[15] << 24;
        text += 20;
        size = chunk < size - 20 ? chunk : size - 20;
    }
    json_t *root = json_loadb(text, size, 0, NULL);
    file_bytes_finish(&bytes);
    json_t *include = json_object_get(root, "include");
    result = gather_named(self, name, json_string_value(include), false, err);
    for (size_t i = 0; i < json_array_size(include) && result >= 0; ++i)
        result =
            gather_named(self, name, json_string_value(json_array_get(include, i)), false, err);
    if (result >= 0)
        result =
            gather_named(self, name, json_string_value(json_object_get(root, "mesh")), false, err);
    if (result >= 0)
        result = gather_uris(self, name, json_object_get(root, "buffers"), err);
    if (result >= 0)
        result = gather_uris(self, name, json_object_get(root, "images"), err);
    json_decref(root);
    return result;
}

typedef struct obj_gathering {
    gathering *to;
    const char *obj;
} obj_gathering;

static mrt_result gather_beside(void *self, const char *name, error *err)
{
    const obj_gathering *of = self;
    return gather_named(of->to, of->obj, name, false, err);
}

/* Adds the materials and pictures of an OBJ. */
static mrt_result gather_obj(gathering *self, const char *name, const char *path, error *err)
{
    file_bytes bytes;
    obj_gathering of = {self, name};
    char *folder = file_directory(path);
    mrt_result result = folder ? file_read(&bytes, path, PACK_BYTES_MAX, err) : no_memory(err);
    if (result >= 0) {
        result = obj_files(bytes.data, bytes.size, folder, gather_beside, &of, err);
        file_bytes_finish(&bytes);
    }
    free(folder);
    return result;
}

static mrt_result gather(gathering *self, const char *name, error *err)
{
    char path[PATH_MAX];
    file_list *list = self->list;
    for (uint32_t i = 0; i < list->count; ++i)
        if (strcmp(list->name[i], name) == 0)
            return MRT_OK;
    if (list->count == PACK_FILES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: the face has more than %d files", name,
                         PACK_FILES_MAX);
    mrt_result result = join(path, self->folder, name, err);
    if (result >= 0)
        result = file_check_below(self->folder, path, err);
    if (result >= 0)
        result = hash_file(list->hash[list->count], path, err);
    if (result < 0)
        return result;
    list->name[list->count] = strdup(name);
    if (!list->name[list->count])
        return no_memory(err);
    list->count += 1;
    const file_extension kind = file_extension_of(name);
    if (strcmp(kind.text, "obj") == 0)
        return gather_obj(self, name, path, err);
    bool is_document = strcmp(kind.text, "json") == 0 || strcmp(kind.text, "gltf") == 0 ||
                       strcmp(kind.text, "glb") == 0 || strcmp(kind.text, "vrm") == 0;
    return is_document ? gather_document(self, name, path, err) : MRT_OK;
}

/* ---- writing ---- */

static mrt_result copy_file(const char *from, const char *to, const char *hash, error *err)
{
    file_bytes bytes;
    char now[TAKE_HASH], folder[PATH_MAX];
    mrt_result result = file_read(&bytes, from, PACK_BYTES_MAX, err);
    if (result < 0)
        return result;
    hash_bytes(now, bytes.data, bytes.size);
    (void)snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(to, '/') - to), to);
    if (strcmp(now, hash) != 0)
        result = error_set(err, MRT_ERR_IO, "%s: changed while it was packed", from);
    if (result >= 0)
        result = file_make_folders(folder, err);
    if (result >= 0)
        result = file_write(to, bytes.data, bytes.size, err);
    file_bytes_finish(&bytes);
    return result;
}

static mrt_result write_list(const file_list *list, const char *folder, error *err)
{
    char path[PATH_MAX];
    json_t *files = json_object();
    for (uint32_t i = 0; i < list->count; ++i)
        (void)json_object_set_new(files, list->name[i], json_string(list->hash[i]));
    json_t *root = json_pack("{si,so}", "marotte_pack", 1, "files", files);
    char *text = root ? json_dumps(root, JSON_INDENT(2)) : NULL;
    json_decref(root);
    mrt_result result = text ? join(path, folder, list_name, err) : no_memory(err);
    if (result >= 0)
        result = file_write(path, text, strlen(text), err);
    free(text);
    return result;
}

/* Removes the existing files of a face, and their folders. */
static void remove_face(const char *folder, const file_list *list)
{
    char path[PATH_MAX];
    error ignored;
    for (uint32_t i = 0; i <= list->count; ++i) {
        if (join(path, folder, i < list->count ? list->name[i] : list_name, &ignored) < 0)
            continue;
        (void)unlink(path);
        for (char *slash = strrchr(path, '/'); slash >= path + strlen(folder);
             slash = strrchr(path, '/')) {
            *slash = '\0';
            (void)rmdir(path);
        }
    }
    (void)rmdir(folder);
}

/* Writes a complete face or nothing: it is created under another name beside it, then renamed.
 * first: name of the first file in `from`. */
static mrt_result write_face(const file_list *list, const char *from, const char *first,
                             const char *pack, const char *folder, error *err)
{
    char meanwhile[PATH_MAX], source[PATH_MAX], to[PATH_MAX];
    (void)os_make_folder(pack);
    mrt_result result = join(meanwhile, pack, "unfinished.XXXXXX", err);
    if (result < 0)
        return result;
    if (!is_folder(pack) || os_make_new_folder(meanwhile) != 0)
        return error_set(err, MRT_ERR_IO, "%s: cannot write: %s", pack, strerror(errno));
    (void)chmod(meanwhile, 0755);
    size_t end = strlen(meanwhile);
    (void)snprintf(meanwhile + end, sizeof meanwhile - end, "/");
    for (uint32_t i = 0; i < list->count && result >= 0; ++i) {
        result = join(source, from, i == 0 ? first : list->name[i], err);
        if (result >= 0)
            result = join(to, meanwhile, list->name[i], err);
        if (result >= 0)
            result = copy_file(source, to, list->hash[i], err);
    }
    if (result >= 0)
        result = write_list(list, meanwhile, err);
    if (result >= 0 && rename(meanwhile, folder) != 0)
        result = error_set(err, MRT_ERR_IO, "%s: cannot write: %s", folder, strerror(errno));
    if (result < 0) {
        remove_face(meanwhile, list);
        (void)rmdir(pack); /* only if it is empty */
    }
    return result;
}

static mrt_result check_same(const file_list *list, const take_performance *p, error *err)
{
    const char *face = p->rig_hash[0] ? p->rig_hash : p->mesh_hash;
    bool has_mesh = false;
    for (uint32_t i = 0; i < list->count; ++i)
        has_mesh |= strcmp(list->hash[i], p->mesh_hash) == 0;
    if (has_mesh && strcmp(list->hash[0], face) == 0)
        return MRT_OK;
    return error_set(err, MRT_ERR_FORMAT,
                     "%s: has changed since it was performed, so it is not packed", p->rig);
}

/* Collects the files of a face. first: name of the face in its folder; the files that it names
 * follow. */
static mrt_result gather_from(file_list *list, char folder[PATH_MAX], char first[PATH_MAX],
                              const char *face_path, error *err)
{
    gathering self = {.list = list};
    const char *slash = strrchr(face_path, '/');
    int length = snprintf(self.folder, PATH_MAX, "%.*s", slash ? (int)(slash + 1 - face_path) : 0,
                          face_path);
    if (length < 0 || length >= PATH_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "%.200s...: the path is too long", face_path);
    (void)snprintf(first, PATH_MAX, "%s", slash ? slash + 1 : face_path);
    (void)snprintf(folder, PATH_MAX, "%s", self.folder);
    return gather(&self, first, err);
}

static mrt_result gather_face(file_list *list, char folder[PATH_MAX], char first[PATH_MAX],
                              const take_performance *p, error *err)
{
    char name[32];
    mrt_result result = gather_from(list, folder, first, p->rig, err);
    if (result >= 0)
        result = check_same(list, p, err);
    if (result >= 0)
        result = face_name(name, p, err);
    for (uint32_t i = 1; result >= 0 && i < list->count; ++i)
        if (strcmp(list->name[i], name) == 0)
            result = error_set(err, MRT_ERR_UNSUPPORTED, "%s: another file has the name %s", p->rig,
                               name);
    if (result < 0)
        return result;
    free(list->name[0]);
    list->name[0] = strdup(name);
    return list->name[0] ? MRT_OK : no_memory(err);
}

/* Writes a face into the pack. It replaces a damaged one. */
static mrt_result put(const file_list *list, const char *from, const char *first,
                      const char *show_path, const take_performance *p, error *err)
{
    char pack[PATH_MAX], folder[PATH_MAX], face[PATH_MAX];
    error damage;
    mrt_result result = pack_folder(pack, show_path, err);
    if (result >= 0)
        result = face_folder(folder, pack, p, err);
    if (result >= 0 && check_face(face, folder, p, &damage) >= 0)
        return MRT_END;
    if (result >= 0 && is_folder(pack) && is_folder(folder))
        remove_face(folder, list);
    return result < 0 ? result : write_face(list, from, first, pack, folder, err);
}

mrt_result pack_add(const char *show_path, const take_performance *p, error *err)
{
    char folder[PATH_MAX], first[PATH_MAX], face[PATH_MAX];
    error missing;
    if (pack_find(face, show_path, p, &missing) == MRT_OK)
        return MRT_END;
    file_list *list = calloc(1, sizeof *list);
    if (!list)
        return no_memory(err);
    mrt_result result = gather_face(list, folder, first, p, err);
    if (result >= 0)
        result = put(list, folder, first, show_path, p, err);
    list_finish(list);
    return result;
}

mrt_result pack_sum(char out[TAKE_HASH], const char *face_path, error *err)
{
    char folder[PATH_MAX], first[PATH_MAX];
    file_list *list = calloc(1, sizeof *list);
    hash_sum *sum = hash_begin();
    mrt_result result =
        list && sum ? gather_from(list, folder, first, face_path, err) : no_memory(err);
    for (uint32_t i = 0; result >= 0 && i < list->count; ++i) {
        hash_add(sum, list->name[i], strlen(list->name[i]) + 1);
        hash_add(sum, list->hash[i], TAKE_HASH);
    }
    hash_end(out, sum);
    list_finish(list);
    return result;
}

mrt_result pack_copy(const char *from_show, const char *to_show, const take_performance *p,
                     error *err)
{
    char face[PATH_MAX], folder[PATH_MAX];
    file_list *list = NULL;
    mrt_result result = pack_find(face, from_show, p, err);
    if (result != MRT_OK)
        return result;
    (void)snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(face, '/') + 1 - face), face);
    result = read_list(&list, folder, err);
    if (result >= 0)
        result = put(list, folder, list->name[0], to_show, p, err);
    list_finish(list);
    return result;
}
