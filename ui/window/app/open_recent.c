#include "window/app/open_recent.h"

#include <string.h>

static const char key[] = "recent";

uint32_t open_recent(const settings *from, const char *out[OPEN_RECENT_MAX])
{
    return settings_list(from, key, out, OPEN_RECENT_MAX);
}

void open_recent_add(settings *to, const char *path)
{
    const char *before[OPEN_RECENT_MAX], *kept[OPEN_RECENT_MAX + 1] = {path};
    const uint32_t known = open_recent(to, before);
    uint32_t count = 1;
    for (uint32_t i = 0; i < known; ++i)
        if (strcmp(before[i], path) != 0)
            kept[count++] = before[i];
    settings_set_list(to, key, kept, count < OPEN_RECENT_MAX ? count : OPEN_RECENT_MAX,
                      OPEN_RECENT_MAX);
}

void open_recent_remove(settings *to, const char *text)
{
    const char *before[OPEN_RECENT_MAX], *kept[OPEN_RECENT_MAX];
    const uint32_t known = open_recent(to, before);
    uint32_t count = 0;
    for (uint32_t i = 0; i < known; ++i)
        if (!strstr(text, before[i]))
            kept[count++] = before[i];
    if (count < known)
        settings_set_list(to, key, kept, count, OPEN_RECENT_MAX);
}
