/* What a process with a vendor's libraries in it writes, record after record; whatever that says of
 * a hand becomes angles that are numbers. */
#include "hand/hand.h"
#include "openxr_record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void read_back(const hand_skeleton *skeleton, const openxr_hand *hand, hand_reading *reading)
{
    hand_landmarks seen = {.doubtful = 0};
    for (uint32_t i = 0; i < MRT_JOINTS; ++i) {
        const uint32_t from = i + 1 + (i > 4) + (i > 8) + (i > 12) + (i > 16);
        seen.at[i] = (mrt_vec3){hand->at[from][0], hand->at[from][1], hand->at[from][2]};
        seen.doubtful |= (hand->valid & hand->tracked) >> from & 1u ? 0 : UINT32_C(1) << i;
    }
    hand_read(skeleton, &seen, reading);
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (!(fabsf(reading->angle_rad[i]) <= 3.2f))
            abort();
    if (!(reading->confidence >= 0.0 && reading->confidence <= 1.0))
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static hand_skeleton *skeleton[2];
    static openxr_record record; /* as in the reader */
    hand_reading reading[2] = {{.confidence = 0.0}, {.confidence = 0.0}};
    for (uint32_t side = 0; side < 2; ++side)
        if (!skeleton[side] && !(skeleton[side] = hand_skeleton_create(side, HAND_LENGTH_MM)))
            return 0;
    for (; size > 0; data += sizeof record, size -= sizeof record) {
        const size_t part = size < sizeof record ? size : sizeof record;
        memset(&record, 0, sizeof record);
        memcpy(&record, data, part);
        if (openxr_record_validate(&record)) {
            if (memchr(record.text, '\0', sizeof record.text) == NULL)
                abort();
            for (const char *c = record.text; *c; ++c)
                if (*c < ' ' || *c > '~')
                    abort();
            for (uint32_t side = 0; side < 2; ++side)
                if (record.hand[side].active)
                    read_back(skeleton[side], &record.hand[side], &reading[side]);
        }
        if (part < sizeof record)
            break;
    }
    return 0;
}
