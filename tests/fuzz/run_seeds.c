/* fuzz_NAME FOLDER - gives each file of a folder to a fuzz target once, where libFuzzer is not
 * linked in. Fails where there is none; what a seed does wrong ends the program. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);

/* libFuzzer's own, for targets that bring a mutator: nothing is mutated here. */
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size)
{
    (void)data, (void)max_size;
    return size;
}

static int run_seed(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END) != 0) {
        perror(path);
        return -1;
    }
    long size = ftell(file);
    uint8_t *bytes = malloc(size > 0 ? (size_t)size : 1); /* exact: sanitizers see what is beyond */
    rewind(file);
    if (!bytes || size < 0 || fread(bytes, 1, (size_t)size, file) != (size_t)size) {
        perror(path);
        return -1;
    }
    fclose(file);
    (void)LLVMFuzzerTestOneInput(bytes, (size_t)size);
    free(bytes);
    return 0;
}

int main(int count, char **argument)
{
    DIR *folder = count == 2 ? opendir(argument[1]) : NULL;
    if (!folder) {
        fprintf(stderr, "usage: %s FOLDER\n", argument[0]);
        return 2;
    }
    int seeds = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        char path[4096];
        if (entry->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, "%s/%s", argument[1], entry->d_name);
        if (run_seed(path) < 0)
            return 1;
        ++seeds;
    }
    closedir(folder);
    printf("%d seeds\n", seeds);
    return seeds > 0 ? 0 : 1;
}
