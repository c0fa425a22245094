/* MIDI bytes from anybody: the first byte says whether low bits refine controllers, or ('t') that
 * the rest is the text of a table. */
#include "midi_table.h"

#include <stdlib.h>
#include <string.h>

static void check(bool is_true)
{
    if (!is_true)
        abort();
}

static void take_text(const char *text, size_t size)
{
    static midi_table table, again;
    char written[MIDI_TABLE_TEXT];
    memset(&table, 0, sizeof table);
    memset(&again, 0, sizeof again);
    midi_table_read(&table, text, size);
    midi_table_build(&table, true);
    check(table.count >= 1 && table.count <= MRT_MAX_CHANNELS);
    midi_table_read(&again, written, midi_table_write(&table, written, sizeof written));
    check(again.heard_count == table.heard_count);
    check(memcmp(again.heard, table.heard, sizeof table.heard) == 0);
}

static void take_event(const midi_event *event)
{
    char name[MIDI_NAME];
    midi_control again;
    check(event->kind > MIDI_NONE && event->kind <= MIDI_SENSING);
    if (event->kind >= MIDI_RELEASE)
        return;
    check(event->value >= -1.0f && event->value < 2592000.0f);
    check(event->kind == MIDI_TIMECODE ? event->rate >= -30.0f && event->rate <= 30.0f
                                       : event->rate == 0.0f);
    midi_control_name(midi_control_of(event), name);
    check(midi_control_parse(&again, name, strlen(name)) && again == midi_control_of(event));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0)
        return 0;
    if (data[0] == 't') {
        char *copy = malloc(size); /* its end is watched */
        if (copy) {
            memcpy(copy, data + 1, size - 1);
            take_text(copy, size - 1);
        }
        free(copy);
        return 0;
    }
    midi_parser parser;
    midi_parser_init(&parser, data[0] & 1);
    for (size_t i = 1; i < size; ++i) {
        midi_event event;
        if (midi_parser_add_byte(&parser, data[i], &event))
            take_event(&event);
    }
    return 0;
}
