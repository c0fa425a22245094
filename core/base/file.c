#include "base/file.h"

#include "base/os.h"
#include "base/suggest.h"
#include "base/text.h"
#include "base/trace.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum {
    SLOTS = 100, /* temporary names, one for each program that writes a target */
    USER_FOLDERS_SIZE_MAX = 64 << 10
};

mrt_result file_read(file_bytes *out, const char *path, size_t size_cap, error *err)
{
    *out = (file_bytes){0};
    mrt_result result = MRT_ERR_IO;
    struct stat status;
    int fd = os_open(path, OS_READ);
    if (fd < 0) {
        const int reason = errno;
        return error_set(err, MRT_ERR_IO, "%s: %s%s", path, strerror(reason),
                         reason == ENOENT ? suggest_file(path).text : "");
    }
    if (fstat(fd, &status) != 0) {
        error_set(err, result, "%s: %s", path, strerror(errno));
        goto fail;
    }
    if (S_ISDIR(status.st_mode)) {
        error_set(err, result, "%s: is a directory, a file was expected", path);
        goto fail;
    }
    if (!S_ISREG(status.st_mode)) {
        error_set(err, result, "%s: is not a regular file", path);
        goto fail;
    }
    if (status.st_size == 0) {
        result = error_set(err, MRT_ERR_FORMAT, "%s: the file is empty", path);
        goto fail;
    }
    if ((uintmax_t)status.st_size > size_cap) {
        result = error_set(err, MRT_ERR_UNSUPPORTED, "%s: %jd bytes, at most %zu are accepted",
                           path, (intmax_t)status.st_size, size_cap);
        goto fail;
    }
    out->data = malloc((size_t)status.st_size + 1);
    if (!out->data) {
        result = error_set(err, MRT_ERR_MEMORY, "%s: no memory for %jd bytes", path,
                           (intmax_t)status.st_size);
        goto fail;
    }
    while (out->size < (size_t)status.st_size) {
        ssize_t got = os_read_at(fd, out->data + out->size, (size_t)status.st_size - out->size,
                                 (int64_t)out->size);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0) {
            error_set(err, result, "%s: %s", path, strerror(errno));
            goto fail;
        }
        if (got == 0)
            break; /* the file shrank during reading: use what was read */
        out->size += (size_t)got;
    }
    if (out->size == 0) {
        result = error_set(err, MRT_ERR_FORMAT, "%s: the file is empty", path);
        goto fail;
    }
    out->data[out->size] = 0;
    close(fd);
    return MRT_OK;
fail:
    close(fd);
    file_bytes_finish(out);
    return result;
}

bool file_next_data(int fd, uint64_t from, uint64_t *out_begin, uint64_t *out_end)
{
    return os_next_data(fd, from, out_begin, out_end);
}

uint64_t file_data_size(const char *path)
{
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode))
        return 0;
    const uint64_t size = (uint64_t)status.st_size, stored = os_stored_bytes(&status);
    return stored == 0 || stored > size ? size : stored;
}

void file_bytes_finish(file_bytes *bytes)
{
    if (!bytes)
        return;
    free(bytes->data);
    *bytes = (file_bytes){0};
}

/* Removes a temporary file without a lock. Its writer holds a lock as long as it lives, so the
 * writer was killed. */
static bool remove_abandoned(const char *name)
{
    struct stat status;
    const int fd = os_open(name, OS_EDIT);
    if (fd < 0)
        return false;
    const bool is_removed = fstat(fd, &status) == 0 && S_ISREG(status.st_mode) &&
                            os_is_mine(&status) && os_lock(fd) == OS_LOCK_HELD &&
                            os_is_at(fd, name) && unlink(name) == 0;
    close(fd);
    return is_removed;
}

/* Creates the file and locks it. Another program may remove it as abandoned before it is locked;
 * then it is not usable. Returns -1 and errno on failure. */
static int make_locked(const char *name)
{
    struct stat made;
    const int fd = os_open(name, OS_CREATE);
    if (fd < 0)
        return -1;
    const bool is_taken = os_lock(fd) == OS_LOCK_OTHERS;
    if (!is_taken && fstat(fd, &made) == 0 && made.st_nlink > 0)
        return fd;
    close(fd);
    errno = EEXIST;
    return -1;
}

/* Creates the temporary file: the name of the target, then ".marotte-", its slot and ".tmp". The
 * mode follows the umask. Removes abandoned files in the slots before and after it. Returns -1 and
 * errno on failure. */
static int make_temporary(char *name, size_t capacity, const char *path)
{
    int fd = -1, slot = 0, reason = EEXIST;
    for (; fd < 0 && slot < SLOTS && reason == EEXIST; ++slot) {
        (void)snprintf(name, capacity, "%s.marotte-%d.tmp", path, slot);
        fd = make_locked(name);
        reason = errno;
        if (fd < 0 && reason == EEXIST && remove_abandoned(name)) {
            fd = make_locked(name);
            reason = errno;
        }
    }
    for (bool is_found = fd >= 0; is_found && slot < SLOTS; ++slot) {
        char other[PATH_MAX];
        (void)snprintf(other, sizeof other, "%s.marotte-%d.tmp", path, slot);
        is_found = access(other, F_OK) == 0;
        (void)remove_abandoned(other);
    }
    errno = reason;
    return fd;
}

mrt_result file_writer_open(file_writer *out, const char *path, error *err)
{
    static const char suffix[] = ".marotte-99.tmp";
    *out = (file_writer){0};
    mrt_result result = MRT_ERR_IO;
    int fd = -1;
    size_t length = strlen(path);
    struct stat status;
    if (length == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "cannot write: the path is empty");
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode))
        return error_set(err, MRT_ERR_IO, "%s: is a %s, cannot write a file there", path,
                         S_ISDIR(status.st_mode) ? "directory" : "device or pipe");
    if (file_make_parent(path, err) < 0)
        return result;
    out->path = strdup(path);
    out->temporary_path = malloc(length + sizeof suffix);
    if (!out->path || !out->temporary_path) {
        result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
        goto fail;
    }
    fd = make_temporary(out->temporary_path, length + sizeof suffix, path);
    if (fd < 0) {
        error_set(err, result, "%s: cannot write: %s", path, strerror(errno));
        free(out->temporary_path);
        out->temporary_path = NULL;
        goto fail;
    }
    out->stream = fdopen(fd, "wb");
    if (!out->stream) {
        error_set(err, result, "%s: cannot write: %s", path, strerror(errno));
        close(fd);
        goto fail;
    }
    return MRT_OK;
fail:
    file_writer_abandon(out);
    return result;
}

/* The lock is held until the temporary name is gone, so that no other program removes or uses that
 * name before. */
mrt_result file_writer_commit(file_writer *writer, error *err)
{
    FILE *stream = writer->stream;
    int failed = ferror(stream) | fflush(stream);
    int reason = errno;
    const int lock = os_duplicate(fileno(stream));
    if (!failed && os_sync(fileno(stream)) != 0 && errno != EINVAL && errno != EROFS) {
        failed = 1;
        reason = errno;
    }
    writer->stream = NULL;
    if (fclose(stream) != 0 && !failed) {
        failed = 1;
        reason = errno;
    }
    if (!failed && os_rename(writer->temporary_path, writer->path) != 0) {
        failed = 1;
        reason = errno;
    }
    mrt_result result = MRT_OK;
    if (failed) {
        result = error_set(err, MRT_ERR_IO, "%s: cannot write: %s", writer->path,
                           reason ? strerror(reason) : "write error");
    } else {
        TRACE(TRACE_IO, "%s: written", writer->path);
        free(writer->temporary_path);
        writer->temporary_path = NULL;
    }
    file_writer_abandon(writer);
    if (lock >= 0)
        close(lock);
    return result;
}

void file_writer_abandon(file_writer *writer)
{
    if (!writer)
        return;
    if (writer->temporary_path)
        (void)unlink(writer->temporary_path);
    if (writer->stream)
        (void)fclose(writer->stream);
    free(writer->temporary_path);
    free(writer->path);
    *writer = (file_writer){0};
}

mrt_result file_write(const char *path, const void *data, size_t size, error *err)
{
    file_writer writer;
    mrt_result result = file_writer_open(&writer, path, err);
    if (result < 0)
        return result;
    (void)fwrite(data, 1, size, writer.stream); /* commit reports a short write */
    return file_writer_commit(&writer, err);
}

file_lock file_lock_folder(int *out_fd, const char *path, int patience_ms)
{
    const struct timespec pause = {.tv_nsec = 1000000};
    char *folder = file_directory(path);
    const int fd = folder ? os_open(folder[0] ? folder : ".", OS_FOLDER) : -1;
    free(folder);
    *out_fd = -1;
    if (fd < 0)
        return FILE_LOCK_UNSUPPORTED;
    for (os_lock_state state; (state = os_lock(fd)) != OS_LOCK_HELD;) {
        if (state == OS_LOCK_REFUSED || patience_ms-- <= 0) {
            close(fd);
            return state == OS_LOCK_OTHERS ? FILE_LOCK_BUSY : FILE_LOCK_UNSUPPORTED;
        }
        (void)nanosleep(&pause, NULL);
    }
    *out_fd = fd;
    return FILE_LOCK_HELD;
}

/* ---- files that another file may name ---- */

static bool climbs(const char *rest)
{
    for (const char *at = rest; at; at = strchr(at, '/')) {
        at += *at == '/';
        if (strncmp(at, "..", 2) == 0 && (at[2] == '/' || at[2] == '\0'))
            return true;
    }
    return rest[0] == '/';
}

static bool begins_with_folder(const char *path, const char *folder)
{
    size_t length = strlen(folder);
    while (length > 0 && folder[length - 1] == '/')
        length -= 1;
    return strncmp(path, folder, length) == 0 && path[length] == '/';
}

static bool is_below(const char *folder, const char *path)
{
    char *real_folder = os_real_path(folder[0] ? folder : "."), *real = os_real_path(path);
    bool below;
    if (real && real_folder)
        below = begins_with_folder(real, real_folder);
    else if (folder[0])
        below = begins_with_folder(path, folder) && !climbs(path + strlen(folder));
    else
        below = !climbs(path);
    free(real_folder);
    free(real);
    return below;
}

mrt_result file_check_below(const char *folder, const char *path, error *err)
{
    const char *named = getenv("MAROTTE_FILE_FOLDERS");
    bool below = is_below(folder, path);
    while (!below && named && named[0]) {
        size_t length = strcspn(named, ":");
        char *one = text_duplicate(named, length);
        below = one && one[0] == '/' && is_below(one, path);
        free(one);
        named += length + (named[length] == ':');
    }
    return below ? MRT_OK
                 : error_set(err, MRT_ERR_UNSUPPORTED,
                             "%s: is not in the folder of the file that names it. Move it "
                             "there, or allow its folder: MAROTTE_FILE_FOLDERS=/THAT/FOLDER",
                             path);
}

mrt_result file_read_below(file_bytes *out, const char *folder, const char *name, size_t size_cap,
                           error *err)
{
    char path[PATH_MAX];
    *out = (file_bytes){0};
    if (!folder || !name[0] || name[0] == '/' || strstr(name, "://"))
        return error_set(err, MRT_ERR_UNSUPPORTED, "only files beside the document are read");
    int length = snprintf(path, sizeof path, "%s%s", folder, name);
    if (length < 0 || (size_t)length >= sizeof path)
        return error_set(err, MRT_ERR_UNSUPPORTED, "the name of a file is too long");
    mrt_result result = file_check_below(folder, path, err);
    return result < 0 ? result : file_read(out, path, size_cap, err);
}

const char *file_name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

char *file_directory(const char *path)
{
    const char *slash = strrchr(path, '/');
    return text_duplicate(path, slash ? (size_t)(slash - path) + 1 : 0);
}

file_extension file_extension_of(const char *path)
{
    file_extension out = {""};
    const char *name = file_name_of(path);
    const char *dot = strrchr(name, '.');
    if (!dot || dot == name || strlen(dot + 1) >= sizeof out.text)
        return out;
    for (size_t i = 0; dot[1 + i]; ++i)
        out.text[i] = (char)tolower((unsigned char)dot[1 + i]);
    return out;
}

/* Reads the value of a line XDG_DOCUMENTS_DIR="$HOME/Documents" of the desktop's user-dirs.dirs: a
 * path that begins with $HOME or '/', in which '\\' quotes the next character. The last line
 * counts, as in a shell. */
static bool find_documents(char out[PATH_MAX], const char *home)
{
    static const char key[] = "XDG_DOCUMENTS_DIR=\"", of_home[] = "$HOME";
    const char *config = getenv("XDG_CONFIG_HOME");
    const bool is_chosen = config && config[0] == '/';
    char path[PATH_MAX];
    file_bytes bytes;
    bool is_found = false;
    const int length = snprintf(path, sizeof path, "%s%s/user-dirs.dirs", is_chosen ? config : home,
                                is_chosen ? "" : "/.config");
    if (length >= (int)sizeof path || file_read(&bytes, path, USER_FOLDERS_SIZE_MAX, NULL) < 0)
        return false;
    for (const char *at = (const char *)bytes.data; at; at = strchr(at, '\n')) {
        at += strspn(at, " \t\n");
        if (strncmp(at, key, sizeof key - 1) != 0)
            continue;
        at += sizeof key - 1;
        const bool is_home = strncmp(at, of_home, sizeof of_home - 1) == 0;
        size_t used = is_home ? (size_t)snprintf(out, PATH_MAX, "%s", home) : 0;
        at += is_home ? sizeof of_home - 1 : 0;
        for (; *at && *at != '"' && *at != '\n' && used < PATH_MAX - 1; ++at) {
            at += *at == '\\' && at[1] ? 1 : 0;
            out[used++] = *at;
        }
        out[used] = '\0';
        is_found = *at == '"' && out[0] == '/';
    }
    file_bytes_finish(&bytes);
    return is_found;
}

mrt_result file_home_path(char *out, size_t capacity, file_home which, const char *rest, error *err)
{
    static const struct {
        const char *variable, *below_home;
    } homes[] = {[FILE_HOME_CONFIG] = {"XDG_CONFIG_HOME", ".config"},
                 [FILE_HOME_DATA] = {"XDG_DATA_HOME", ".local/share"},
                 [FILE_HOME_CACHE] = {"XDG_CACHE_HOME", ".cache"},
                 [FILE_HOME_DOCUMENTS] = {"XDG_DOCUMENTS_DIR", ""}};
    const char *chosen = getenv(homes[which].variable), *home = getenv("HOME");
    char documents[PATH_MAX];
    int length = -1;
    if ((!chosen || chosen[0] != '/') && which == FILE_HOME_DOCUMENTS && home && home[0] == '/')
        chosen = find_documents(documents, home) ? documents : home;
    if (chosen && chosen[0] == '/')
        length = snprintf(out, capacity, "%s/marotte/%s", chosen, rest);
    else if (home && home[0] == '/')
        length = snprintf(out, capacity, "%s/%s/marotte/%s", home, homes[which].below_home, rest);
    if (length > 0 && (size_t)length < capacity)
        return MRT_OK;
    if (capacity > 0)
        out[0] = '\0';
    return error_set(err, MRT_ERR_IO, "cannot find the folder marotte/%s: set HOME", rest);
}

static bool is_folder(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

mrt_result file_make_folders(const char *path, error *err)
{
    char *partial = strdup(path);
    if (!partial)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    mrt_result result = MRT_OK;
    for (char *slash = partial; slash && *slash && result >= 0;) {
        slash = strchr(slash + 1, '/');
        if (slash)
            *slash = '\0';
        if (os_make_folder(partial) != 0) {
            const int reason = errno == EEXIST ? ENOTDIR : errno;
            if (!is_folder(partial))
                result = error_set(err, MRT_ERR_IO, "%s: cannot create this folder: %s", partial,
                                   strerror(reason));
        }
        if (slash)
            *slash = '/';
    }
    free(partial);
    return result;
}

mrt_result file_make_parent(const char *path, error *err)
{
    size_t length = strlen(path);
    while (length > 1 && path[length - 1] == '/')
        length -= 1;
    while (length > 0 && path[length - 1] != '/')
        length -= 1;
    while (length > 1 && path[length - 1] == '/')
        length -= 1;
    char *folder = text_duplicate(path, length);
    if (!folder)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    mrt_result result = length == 0 || is_folder(folder) ? MRT_OK : file_make_folders(folder, err);
    free(folder);
    return result;
}
