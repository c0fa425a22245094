/* Lines of JSON, as a show keeps them, folded onto a take: each is refused with a reason, or it
 * leaves a take that holds together and is written as it was read. */
#include "show/history.h"
#include "show/own.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds, const char *what)
{
    if (holds)
        return;
    fprintf(stderr, "does not hold: %s\n", what);
    abort();
}

static void apply_text(take *t, const char *text)
{
    edit e;
    error err = {""};
    if (edit_parse(&e, text, strlen(text), &err) < 0 || edit_apply(t, &e, &err) < 0)
        require(false, err.text);
    edit_finish(&e);
}

static void check_written(const edit *e)
{
    char *text, *again;
    edit back;
    error err = {""};
    require(edit_write(&text, e, &err) >= 0, "what was read is written");
    require(edit_parse(&back, text, strlen(text), &err) >= 0, "what was written is read");
    require(edit_write(&again, &back, &err) >= 0 && strcmp(text, again) == 0, "the same again");
    edit_finish(&back);
    free(text);
    free(again);
}

static void check_voices(const take *t, int64_t at_ns)
{
    double weight[EDIT_LAYERS_MAX], sum = 0.0;
    own_weights(weight, t, "jaw.open", at_ns);
    for (uint32_t i = 0; i < t->layer_count; ++i) {
        require(weight[i] >= 0.0 && weight[i] <= 1.0, "weights from 0 to 1");
        sum += t->layer[i].is_additive ? 0.0 : weight[i];
    }
    require(sum <= 1.0 + 1e-9, "weights sum to at most 1");
}

static void apply_line(take *t, const char *line, size_t size)
{
    edit e;
    error err = {""};
    char words[EDIT_TEXT];
    if (edit_parse(&e, line, size, &err) < 0) {
        require(err.text[0] != '\0' && !strchr(err.text, '\n'), "one line of reason");
        require(!e.own && !e.warp, "nothing is left on failure");
        return;
    }
    check_written(&e);
    edit_describe(words, &e, t);
    require(strlen(words) > 0 && !strchr(words, '\n'), "one line of words");
    if (edit_apply(t, &e, &err) < 0)
        require(err.text[0] != '\0' && !strchr(err.text, '\n'), "one line of reason");
    require(edit_check(t, &err) >= 0, err.text);
    check_voices(t, e.at_ns == EDIT_UNSAID ? 0 : e.at_ns);
    edit_finish(&e);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    take t = {.id = 1, .start_ns = 1000000000000, .duration_ns = 10000000000};
    apply_text(&t, "{\"op\":\"layer.add\",\"name\":\"face\"}");
    apply_text(&t, "{\"op\":\"clip.add\",\"layer\":1,\"performance\":7}");
    const char *at = (const char *)data, *end = at + size;
    for (int line = 0; at < end && line < 64; ++line) {
        const char *newline = memchr(at, '\n', (size_t)(end - at));
        apply_line(&t, at, (size_t)((newline ? newline : end) - at));
        at = newline ? newline + 1 : end;
    }
    take_finish(&t);
    return 0;
}
