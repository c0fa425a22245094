#include "openxr_record.h"

#include <math.h>
#include <string.h>

static const float farthest_m = 1000.0f;

static bool is_sound(const openxr_hand *hand)
{
    if (hand->active != 1)
        return false;
    for (uint32_t i = 0; i < OPENXR_JOINTS; ++i)
        for (int k = 0; k < 3 && (hand->valid >> i & 1u); ++k)
            if (!(fabsf(hand->at[i][k]) <= farthest_m))
                return false;
    return true;
}

static void clean_text(char text[OPENXR_TEXT])
{
    text[OPENXR_TEXT - 1] = '\0';
    for (char *c = text; *c; ++c)
        if (*c < ' ' || *c > '~')
            *c = '?';
}

bool openxr_record_take(openxr_record *record)
{
    if (record->magic != OPENXR_MAGIC || record->kind < OPENXR_FRAME || record->kind > OPENXR_END)
        return false;
    clean_text(record->text);
    for (int side = 0; side < 2; ++side)
        if (!is_sound(&record->hand[side]))
            memset(&record->hand[side], 0, sizeof record->hand[side]);
    return true;
}
