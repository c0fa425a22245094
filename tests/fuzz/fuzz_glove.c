/* Any bytes are records, answers and layouts of a CyberGlove, or are not; what is read keeps the
 * parser's promises. The first byte chooses the layout, the second how the rest is cut in pieces.
 */
#include "glove_clock.h"
#include "glove_parse.h"

#include <assert.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static glove_layout layout_of(uint8_t choice)
{
    static const uint32_t counts[] = {22, 18, 1, GLOVE_SENSORS_MAX};
    return (glove_layout){.form = choice & 1 ? GLOVE_WORDS : GLOVE_BYTES,
                          .head = choice & 2 ? 'G' : 'S',
                          .sensor_count = counts[choice >> 2 & 3],
                          .has_time = (choice & 16) != 0,
                          .has_status = (choice & 32) != 0};
}

static void check_record(const glove_parse *parse, const glove_record *record)
{
    uint32_t most = parse->layout.form == GLOVE_WORDS ? 4095 : 255;
    for (uint32_t i = 0; i < parse->layout.sensor_count; ++i)
        assert(record->sensor[i] >= 1 && record->sensor[i] <= most);
    assert(record->status == 0 || (record->status & GLOVE_STATUS_VALID));
}

/* Every byte is of a record, is garbage, or is still held. */
static void check_account(const glove_parse *parse, size_t taken)
{
    size_t plain = glove_layout_size(&parse->layout);
    size_t records = taken - parse->garbage_bytes - parse->count;
    assert(parse->garbage_bytes + parse->count <= taken);
    assert(records >= parse->good_count * plain && records <= parse->good_count * (plain + 4));
}

static void parse_all(const uint8_t *bytes, size_t size, glove_layout layout, size_t piece)
{
    glove_parse parse;
    glove_clock clock;
    glove_record record;
    int64_t now_ns = 1000000000, last_ns = 0;
    glove_parse_init(&parse, &layout);
    glove_clock_init(&clock, layout.has_time ? GLOVE_BY_STAMP : GLOVE_BY_RATE, 6666667);
    for (size_t at = 0; at < size;) {
        size_t part = piece < size - at ? piece : size - at;
        size_t room = glove_parse_room(&parse);
        assert(room > 0);
        part = part < room ? part : room;
        glove_parse_append(&parse, bytes + at, part);
        at += part;
        while (glove_parse_next(&parse, &record)) {
            check_record(&parse, &record);
            now_ns += 1000000 * (int64_t)bytes[at - 1];
            int64_t time_ns = glove_clock_time(&clock, &record, now_ns);
            assert(time_ns <= now_ns && time_ns >= last_ns);
            last_ns = time_ns;
        }
        check_account(&parse, at);
    }
}

static uint32_t mask_of(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] << 16 | (uint32_t)bytes[1] << 8 | bytes[2];
}

static void answer_all(const uint8_t *bytes, size_t size)
{
    unsigned char value[4];
    (void)glove_reply_value(bytes, size, 'G', value, 1);
    (void)glove_reply_value(bytes, size, 'T', value, 4);
    (void)glove_reply_done(bytes, size, 't');
    glove_layout guess = {.head = 'S', .sensor_count = 22};
    if (glove_layout_guess(bytes, size, &guess))
        assert(guess.sensor_count == 18 || guess.sensor_count == 22);
    if (size >= 8) {
        const glove_reported census = {bytes[0], mask_of(bytes + 1), mask_of(bytes + 4), bytes[7]};
        glove_sensors sensors;
        if (glove_sensors_find(&census, &sensors))
            assert(sensors.count >= 1 && sensors.count <= GLOVE_SENSORS_MAX);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    if (size < 3)
        return 0;
    parse_all(bytes + 2, size - 2, layout_of(bytes[0]), 1 + bytes[1] % 128u);
    answer_all(bytes + 2, size - 2);
    return 0;
}
