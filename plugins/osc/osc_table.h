/* plugins/osc/osc_table.h - the channels of one source as one marotte tells them to another, and
 * the three messages in which samples travel: /marotte/1/channels  s source, i version, then for
 * each channel s name, s unit, i semantic, i hand, f min, f max /marotte/1/sample    s source, i
 * version, i sequence, h time_ns, h sent_ns, f value ... /marotte/1/end       s source, i version
 * Writing them; reading is osc_event.h. Pure but for liblo's allocations; any thread. */
#ifndef MAROTTE_OSC_TABLE_H
#define MAROTTE_OSC_TABLE_H
#include <marotte/plugin.h>

enum { OSC_SOURCE_LENGTH = 96, OSC_NAME_LENGTH = 64, OSC_UNIT_LENGTH = 16 };

typedef struct osc_table {
    char source[OSC_SOURCE_LENGTH];
    int32_t version; /* another one: other channels, or sequence numbers that start again */
    uint32_t count;
    mrt_channel channel[MRT_MAX_CHANNELS]; /* name and unit point into this struct:
                                              osc_table_copy, not = */
    char name[MRT_MAX_CHANNELS][OSC_NAME_LENGTH], unit[MRT_MAX_CHANNELS][OSC_UNIT_LENGTH];
} osc_table;

/* Fills the table. False, and it is as it was: a text is missing, too long or not printable, a
 * count or number is out of range. */
bool osc_table_set(osc_table *out, const char *source, int32_t version, const mrt_channel *channels,
                   uint32_t count);
void osc_table_copy(osc_table *out, const osc_table *from);
/* Whether the channels are these, in everything that a channel says. */
bool osc_table_has(const osc_table *table, const mrt_channel *channels, uint32_t count);
/* Text that can be shown: printable ASCII or bytes of UTF-8, shorter than `capacity`. */
bool osc_table_is_text(const char *text, size_t capacity);

/* The packet's size; 0: no memory or no room. */
size_t osc_table_write(const osc_table *table, void *out, size_t capacity);
size_t osc_table_write_sample(const osc_table *table, const mrt_sample *sample, int64_t sent_ns,
                              void *out, size_t capacity);
size_t osc_table_write_end(const osc_table *table, void *out, size_t capacity);

#endif
