#include "show/hash.h"

#include "base/os.h"

#include <errno.h>
#include <nettle/sha2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PIECE_BYTES = 65536 };

static void write_hex(char out[TAKE_HASH], struct sha256_ctx *state)
{
    static const char digit[] = "0123456789abcdef";
    uint8_t digest[SHA256_DIGEST_SIZE];
    sha256_digest(state, sizeof digest, digest);
    for (size_t i = 0; i < sizeof digest; ++i) {
        out[2 * i] = digit[digest[i] >> 4];
        out[2 * i + 1] = digit[digest[i] & 15];
    }
    out[2 * sizeof digest] = '\0';
}

void hash_bytes(char out[TAKE_HASH], const void *bytes, size_t size)
{
    struct sha256_ctx state;
    sha256_init(&state);
    sha256_update(&state, size, bytes);
    write_hex(out, &state);
}

static mrt_result hash_stream(char out[TAKE_HASH], int fd, const char *path, error *err)
{
    uint8_t piece[PIECE_BYTES];
    struct sha256_ctx state;
    struct stat status;
    if (fstat(fd, &status) != 0 || !S_ISREG(status.st_mode))
        return error_set(err, MRT_ERR_IO, "%s: is not a regular file", path);
    sha256_init(&state);
    for (;;) {
        ssize_t got = read(fd, piece, sizeof piece);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return error_set(err, MRT_ERR_IO, "%s: %s", path, strerror(errno));
        if (got == 0)
            break;
        sha256_update(&state, (size_t)got, piece);
    }
    write_hex(out, &state);
    return MRT_OK;
}

mrt_result hash_file(char out[TAKE_HASH], const char *path, error *err)
{
    out[0] = '\0';
    int fd = os_open(path, OS_READ);
    if (fd < 0)
        return error_set(err, MRT_ERR_IO, "%s: %s", path, strerror(errno));
    mrt_result result = hash_stream(out, fd, path, err);
    close(fd);
    return result;
}

struct hash_sum {
    struct sha256_ctx state;
};

hash_sum *hash_begin(void)
{
    hash_sum *sum = malloc(sizeof *sum);
    if (sum)
        sha256_init(&sum->state);
    return sum;
}

void hash_add(hash_sum *sum, const void *bytes, size_t size)
{
    sha256_update(&sum->state, size, bytes);
}

void hash_end(char out[TAKE_HASH], hash_sum *sum)
{
    out[0] = '\0';
    if (!sum)
        return;
    write_hex(out, &sum->state);
    free(sum);
}
