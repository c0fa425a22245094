#include "stage/voice/phone_list.h"

#include <stdlib.h>

const char *const phone_name[PHONE_COUNT] = {
    "_", "AA", "AE", "AH", "AO", "AW", "AY", "B", "CH", "D", "DH", "EH", "ER", "EY",
    "F", "G",  "HH", "IH", "IY", "JH", "K",  "L", "M",  "N", "NG", "OW", "OY", "P",
    "R", "S",  "SH", "T",  "TH", "UH", "UW", "V", "W",  "Y", "Z",  "ZH"};

bool phone_is_vowel(phone_sound sound)
{
    switch (sound) {
    case PHONE_AA:
    case PHONE_AE:
    case PHONE_AH:
    case PHONE_AO:
    case PHONE_AW:
    case PHONE_AY:
    case PHONE_EH:
    case PHONE_ER:
    case PHONE_EY:
    case PHONE_IH:
    case PHONE_IY:
    case PHONE_OW:
    case PHONE_OY:
    case PHONE_UH:
    case PHONE_UW:
        return true;
    default:
        return false;
    }
}

/* ---- lists ---- */

void phone_list_finish(phone_list *list)
{
    free(list->phone);
    *list = (phone_list){0};
}

mrt_result phone_list_add(phone_list *list, phone_sound sound, double start_s, double end_s,
                          error *err)
{
    if ((list->count & (list->count - 1)) == 0) {
        phone *larger = realloc(list->phone, (list->count ? 2 * list->count : 1) * sizeof *larger);
        if (!larger)
            return error_set(err, MRT_ERR_MEMORY, "no memory for the sounds of the voice");
        list->phone = larger;
    }
    list->phone[list->count++] = (phone){.start_s = start_s, .end_s = end_s, .sound = sound};
    return MRT_OK;
}
