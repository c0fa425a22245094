/* stream/mp4.h - checks whether an .mp4 of another program is complete: it has an index, its boxes
 * (ISO/IEC 14496-12) end where the file ends, and the index counts the pictures. Leaves out what
 * the pictures show. Reads only headers, so that the time does not depend on the length of the
 * film. [any thread that may block] */
#ifndef MAROTTE_UI_STREAM_MP4_H
#define MAROTTE_UI_STREAM_MP4_H
#include <stdbool.h>
#include <stdint.h>

typedef struct mp4_facts {
    bool is_complete;
    uint64_t picture_count; /* of the video tracks */
    bool has_sound;
} mp4_facts;

/* fd: opened for reading; its position does not change. */
void mp4_read(mp4_facts *out, int fd);

#endif
