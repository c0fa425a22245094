#include "take/edit_parts.h"

#include <stdio.h>
#include <string.h>

static const int64_t second_ns = 1000000000;

edit_words edit_seconds(int64_t time_ns)
{
    edit_words out;
    uint64_t size = time_ns < 0 ? 0 - (uint64_t)time_ns : (uint64_t)time_ns;
    int length = snprintf(out.text, sizeof out.text, "%s%llu.%09llu", time_ns < 0 ? "-" : "",
                          (unsigned long long)(size / (uint64_t)second_ns),
                          (unsigned long long)(size % (uint64_t)second_ns));
    while (out.text[length - 1] == '0')
        out.text[--length] = '\0';
    if (out.text[length - 1] == '.')
        out.text[length - 1] = '\0';
    return out;
}

edit_words edit_span_words(int64_t from_ns, int64_t until_ns)
{
    edit_words out;
    (void)snprintf(out.text, sizeof out.text, "%.40s .. %.40s s", edit_seconds(from_ns).text,
                   edit_seconds(until_ns).text);
    return out;
}

edit_words edit_layer_words(const take_layer *layer)
{
    edit_words out;
    (void)snprintf(out.text, sizeof out.text, "layer %u '%.63s'", layer->id, layer->name);
    return out;
}

edit_words edit_clip_words(const take_layer *layer, const take_clip *clip)
{
    edit_words out;
    edit_words span =
        edit_span_words(clip->start_ns + layer->offset_ns, clip->end_ns + layer->offset_ns);
    (void)snprintf(out.text, sizeof out.text, "clip %u of '%.30s' (%.60s)", clip->id, layer->name,
                   span.text);
    return out;
}
