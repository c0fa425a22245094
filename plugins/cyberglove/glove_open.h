/* cyberglove/glove_open.h - from an address to a glove that sends: which port it is, also when it
 * comes back as another, or the first port at which a glove answers. [main] [input]. */
#ifndef MAROTTE_CYBERGLOVE_OPEN_H
#define MAROTTE_CYBERGLOVE_OPEN_H
#include "glove_drive.h"
#include "glove_find.h"

/* The glove that the instance had, to find it again. */
typedef struct glove_memory {
    bool has_had;
    char address[192]; /* as it was opened */
    glove_found port;  /* path and, if it is known, place */
} glove_memory;

/* root: "" but in tests. On success the drive has begun. */
mrt_result glove_open(glove_drive *drive, const char *address, const char *root,
                      glove_memory *memory, glove_why *why);

/* The address by which it is found wherever its port turns up. */
void glove_open_address(const glove_found *port, char *out, size_t capacity);

#endif
