#include "glove_parse.h"
#include "device_io.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

enum {
    TIME_BYTES = 5,
    COMPLAINTS_MAX = 2,
    COMPLAINT_BYTES = 2,
    WORDS_HEAD = 14,  /* "HH:MM:SS:ff:nS" */
    WORDS_TAIL = 3,   /* CR LF NUL */
    WORDS_PREFIX = 3, /* an occasional "nS" before the time */
    GUESS_RECORDS = 4
};

typedef struct span {
    size_t start, size;
} span;

typedef enum finding { NOTHING, NEED_MORE, FOUND } finding;

size_t glove_layout_size(const glove_layout *layout)
{
    assert(layout->sensor_count <= GLOVE_SENSORS_MAX);
    if (layout->form == GLOVE_WORDS)
        return WORDS_HEAD + 2 * (size_t)layout->sensor_count + WORDS_TAIL;
    return 1 + (size_t)layout->sensor_count + (layout->has_time ? TIME_BYTES : 0) +
           (layout->has_status ? 1 : 0) + 1;
}

void glove_parse_init(glove_parse *self, const glove_layout *layout)
{
    *self = (glove_parse){.layout = *layout};
    if (self->layout.sensor_count > GLOVE_SENSORS_MAX)
        self->layout.sensor_count = GLOVE_SENSORS_MAX;
}

void glove_parse_restart(glove_parse *self)
{
    self->count = 0;
    self->torn = 0;
    self->garbage = 0;
    self->has_record = false;
}

size_t glove_parse_room(const glove_parse *self)
{
    return GLOVE_PARSE_BYTES - self->count;
}

void glove_parse_append(glove_parse *self, const unsigned char *bytes, size_t size)
{
    size_t taken = size < glove_parse_room(self) ? size : glove_parse_room(self);
    memcpy(self->bytes + self->count, bytes, taken);
    self->count += taken;
}

size_t glove_parse_missing(const glove_parse *self)
{
    size_t size = glove_layout_size(&self->layout);
    if (self->count == 0)
        return 0;
    return self->count < size ? size - self->count : 1;
}

static void drop(glove_parse *self, size_t size)
{
    memmove(self->bytes, self->bytes + size, self->count - size);
    self->count -= size;
}

static void drop_garbage(glove_parse *self, size_t size)
{
    self->garbage += size;
    self->garbage_bytes += size;
    drop(self, size);
}

/* Converts garbage bytes to a number of lost records. */
static uint32_t take_lost(glove_parse *self, size_t harmless)
{
    size_t size = glove_layout_size(&self->layout);
    size_t lost = size > 0 ? (self->garbage + size / 2) / size : 0;
    if (lost == 0 && self->garbage > harmless)
        lost = 1;
    if (!self->has_record)
        lost = 0;
    self->garbage = 0;
    self->has_record = true;
    self->good_count += 1;
    self->lost_count += lost;
    return (uint32_t)lost;
}

/* ---- records of bytes ---- */

/* A record begins after a NUL. After bytes without one, it begins where complete records would have
 * ended, or one byte before or after. So a damaged or missing NUL does not cost the next record. */
static bool may_start(const glove_parse *self, size_t start)
{
    size_t since = self->torn + start;
    size_t size = glove_layout_size(&self->layout);
    return since == 0 || (since + 1 >= size && (since + 1) % size <= 2);
}

static bool are_complaints(const unsigned char *bytes, size_t size)
{
    for (size_t i = 0; i < size; i += COMPLAINT_BYTES)
        if (bytes[i] != 'e' || (bytes[i + 1] != 's' && bytes[i + 1] != 'g'))
            return false;
    return true;
}

/* Returns true if `size` bytes are a record: head, no 0 except the end and perhaps the flags. */
static bool is_record(const glove_layout *layout, const unsigned char *bytes, size_t size,
                      bool flags_may_be_0)
{
    size_t plain = glove_layout_size(layout);
    if (bytes[0] != layout->head || bytes[size - 1] != 0)
        return false;
    size_t flags = flags_may_be_0 ? 1 + layout->sensor_count : 0;
    for (size_t i = 1; i + 1 < size; ++i)
        if (bytes[i] == 0 && i != flags)
            return false;
    return are_complaints(bytes + plain - 1, size - plain);
}

/* Finds a record that ends at the NUL. */
static finding find_ending_at(const glove_parse *self, size_t zero, span *out)
{
    size_t plain = glove_layout_size(&self->layout);
    for (size_t k = 0; k <= COMPLAINTS_MAX; ++k) {
        size_t size = plain + k * COMPLAINT_BYTES;
        if (size > zero + 1)
            break;
        *out = (span){zero + 1 - size, size};
        if (may_start(self, out->start) &&
            is_record(&self->layout, self->bytes + out->start, size, false))
            return FOUND;
    }
    return NOTHING;
}

/* Finds a record in which this NUL is the flags byte of the time stamp. It counts if everything
 * else matches, and if this glove does not mark its flags. */
static finding find_flags_at(const glove_parse *self, size_t zero, span *out)
{
    size_t flags = 1 + self->layout.sensor_count;
    if (!self->layout.has_time || self->flags_are_marked || zero < flags)
        return NOTHING;
    size_t start = zero - flags;
    if (!may_start(self, start) || self->bytes[start] != self->layout.head)
        return NOTHING;
    for (size_t k = 0; k <= COMPLAINTS_MAX; ++k) {
        *out = (span){start, glove_layout_size(&self->layout) + k * COMPLAINT_BYTES};
        if (out->start + out->size > self->count)
            return NEED_MORE;
        if (is_record(&self->layout, self->bytes + start, out->size, true))
            return FOUND;
        if (self->bytes[out->start + out->size - 1] == 0)
            break;
    }
    return NOTHING;
}

/* t0 is the low byte; a byte that should be 0 is sent as 1 and its bit in the flags is set. */
static uint32_t ticks_of(const unsigned char *bytes)
{
    uint32_t ticks = 0;
    for (uint32_t i = 0; i < 4; ++i) {
        uint32_t byte = bytes[1 + i] ^ ((uint32_t)bytes[0] >> i & 1u);
        ticks |= byte << (8 * i);
    }
    return ticks;
}

static void read_bytes(glove_parse *self, const unsigned char *bytes, size_t size,
                       glove_record *out)
{
    const glove_layout *layout = &self->layout;
    for (uint32_t i = 0; i < layout->sensor_count; ++i)
        out->sensor[i] = bytes[1 + i];
    size_t at = 1 + layout->sensor_count;
    if (layout->has_time) {
        out->ticks = ticks_of(bytes + at);
        if (bytes[at] != 0)
            self->flags_are_marked = (bytes[at] & 128u) != 0;
        at += TIME_BYTES;
    }
    if (layout->has_status) {
        out->status = (bytes[at] & GLOVE_STATUS_VALID) ? bytes[at] : 0;
        at += 1;
    }
    for (; at + COMPLAINT_BYTES < size; at += COMPLAINT_BYTES) {
        out->is_too_fast |= bytes[at + 1] == 's';
        out->is_unplugged |= bytes[at + 1] == 'g';
    }
}

/* Discards long garbage without a NUL, except the bytes that the next record may need. */
static void tear(glove_parse *self)
{
    size_t kept = 2 * glove_layout_size(&self->layout) + COMPLAINTS_MAX * COMPLAINT_BYTES;
    if (self->count < GLOVE_PARSE_BYTES || kept >= GLOVE_PARSE_BYTES)
        return;
    self->torn += self->count - kept;
    drop_garbage(self, self->count - kept);
}

static bool next_bytes(glove_parse *self, glove_record *out)
{
    for (;;) {
        const unsigned char *nul = memchr(self->bytes, 0, self->count);
        if (!nul) {
            tear(self);
            return false;
        }
        size_t zero = (size_t)(nul - self->bytes);
        span found;
        finding result = find_ending_at(self, zero, &found);
        if (result == NOTHING)
            result = find_flags_at(self, zero, &found);
        if (result == NEED_MORE) {
            self->torn += found.start;
            drop_garbage(self, found.start);
            return false;
        }
        self->torn = result == FOUND ? self->torn : 0;
        if (result == NOTHING) {
            drop_garbage(self, zero + 1);
            continue;
        }
        drop_garbage(self, found.start);
        read_bytes(self, self->bytes, found.size, out);
        drop(self, found.size);
        self->torn = 0;
        out->lost = take_lost(self, 0);
        return true;
    }
}

/* ---- records of words ---- */

static bool is_digit(unsigned char byte)
{
    return byte >= '0' && byte <= '9';
}

/* Returns true if the first `count` bytes can be the beginning of "HH:MM:SS:ff:nS". */
static bool begins_words(const unsigned char *bytes, size_t count)
{
    for (size_t i = 0; i < count && i < WORDS_HEAD; ++i) {
        bool fits = i == WORDS_HEAD - 1 ? bytes[i] == 'S'
                    : i % 3 == 2        ? bytes[i] == ':'
                                        : is_digit(bytes[i]);
        if (!fits)
            return false;
    }
    return true;
}

static bool read_words(const glove_parse *self, glove_record *out)
{
    size_t size = glove_layout_size(&self->layout);
    if (memcmp(self->bytes + size - WORDS_TAIL, "\r\n", WORDS_TAIL) != 0)
        return false;
    for (uint32_t i = 0; i < self->layout.sensor_count; ++i) {
        const unsigned char *word = self->bytes + WORDS_HEAD + 2 * (size_t)i;
        uint32_t value = (uint32_t)word[0] << 8 | word[1];
        if (value == 0 || value > 4095)
            return false;
        out->sensor[i] = (uint16_t)value;
    }
    return true;
}

static bool next_words(glove_parse *self, glove_record *out)
{
    size_t size = glove_layout_size(&self->layout);
    while (self->count > 0) {
        size_t start = 0;
        while (start < self->count && !begins_words(self->bytes + start, self->count - start))
            start += 1;
        drop_garbage(self, start);
        if (self->count < size)
            return false;
        if (read_words(self, out)) {
            drop(self, size);
            out->lost = take_lost(self, WORDS_PREFIX);
            return true;
        }
        drop_garbage(self, 1);
    }
    return false;
}

bool glove_parse_next(glove_parse *self, glove_record *out)
{
    *out = (glove_record){0};
    return self->layout.form == GLOVE_WORDS ? next_words(self, out) : next_bytes(self, out);
}

/* ---- guessing another layout ---- */

/* Returns the size of the last four records if they have one size and begin with the head; else
 * 0. */
static size_t repeated_size(const unsigned char *bytes, size_t count, unsigned char head)
{
    size_t size = 0;
    uint32_t in_a_row = 0;
    const unsigned char *end = bytes + count;
    const unsigned char *nul;
    for (const unsigned char *at = bytes; (nul = memchr(at, 0, (size_t)(end - at))) != NULL;
         at = nul + 1) {
        size_t this_size = (size_t)(nul - at) + 1;
        in_a_row = this_size == size && at[0] == head ? in_a_row + 1 : at[0] == head;
        size = this_size;
        if (in_a_row >= GUESS_RECORDS)
            return size;
    }
    return 0;
}

bool glove_layout_guess(const unsigned char *bytes, size_t count, glove_layout *layout)
{
    if (layout->form != GLOVE_BYTES)
        return false;
    size_t size = repeated_size(bytes, count, layout->head);
    const uint32_t sensor_counts[] = {layout->sensor_count, 18, 22};
    for (size_t i = 0; size > 0 && i < sizeof sensor_counts / sizeof *sensor_counts; ++i)
        for (uint32_t k = 0; k < 4; ++k) {
            glove_layout other = *layout;
            other.sensor_count = sensor_counts[i];
            other.has_time = (k & 2) != 0;
            other.has_status = (k & 1) != 0;
            if (glove_layout_size(&other) == size) {
                *layout = other;
                return true;
            }
        }
    return false;
}

/* ---- answers ---- */

enum { TEXT_MAX = 24 };

static bool is_small_text(unsigned char byte)
{
    return byte == ' ' || byte == '\r' || byte == '\n' || (byte >= '0' && byte <= '9');
}

/* Returns true if blanks, line ends, numbers and then a NUL follow. */
static bool ends_soon(const unsigned char *bytes, size_t count)
{
    for (size_t i = 0; i < count && i < TEXT_MAX; ++i) {
        if (bytes[i] == 0)
            return true;
        if (!is_small_text(bytes[i]))
            return false;
    }
    return false;
}

/* An answer begins at the start, or after the end of another one. */
static bool may_begin_reply(const unsigned char *bytes, size_t at)
{
    return at == 0 || bytes[at - 1] == 0 || is_small_text(bytes[at - 1]);
}

static bool is_refusal(const unsigned char *bytes, size_t count, size_t at)
{
    return count - at > 2 && bytes[at] == 'e' && bytes[at + 1] != 0 &&
           strchr("?nysg", bytes[at + 1]) && may_begin_reply(bytes, at) &&
           ends_soon(bytes + at + 2, count - at - 2);
}

glove_reply glove_reply_value(const unsigned char *bytes, size_t count, char letter,
                              unsigned char *out_value, size_t value_size)
{
    for (size_t i = 0; i < count; ++i) {
        if (is_refusal(bytes, count, i))
            return GLOVE_REFUSED;
        if (bytes[i] != '?' || count - i < value_size + 3)
            continue;
        if (bytes[i + 1] != (unsigned char)letter || bytes[i + 2 + value_size] != 0)
            continue;
        memcpy(out_value, bytes + i + 2, value_size);
        return GLOVE_ANSWERED;
    }
    return GLOVE_SILENT;
}

glove_reply glove_reply_done(const unsigned char *bytes, size_t count, char letter)
{
    const unsigned char small = (unsigned char)(letter | 0x20), large = small & 0xDFu;
    for (size_t i = 0; i < count; ++i) {
        if (is_refusal(bytes, count, i))
            return GLOVE_REFUSED;
        if ((bytes[i] == small || bytes[i] == large) && may_begin_reply(bytes, i) &&
            ends_soon(bytes + i + 1, count - i - 1))
            return GLOVE_ANSWERED;
    }
    return GLOVE_SILENT;
}

/* ---- sensors ---- */

enum { MASK_BITS = 24, INDEX_ABDUCTION_BIT = 7, WRIST_YAW_BIT = 22 };

const char *glove_sensor_name(uint32_t semantic)
{
    bool is_angle = semantic >= MRT_CH_ANGLE && semantic < MRT_CH_ANGLE + MRT_ANGLES;
    return is_angle ? device_sensor_name[semantic - MRT_CH_ANGLE] : "extra";
}

/* Bits are in the order of the sensors; the index finger has no abduction sensor. */
static uint32_t semantic_of_bit(uint32_t bit)
{
    if (bit == INDEX_ABDUCTION_BIT || bit > WRIST_YAW_BIT)
        return MRT_CH_OTHER;
    return MRT_CH_ANGLE + (bit < INDEX_ABDUCTION_BIT ? bit : bit - 1);
}

static glove_sensors of_mask(uint32_t mask)
{
    glove_sensors out = {0};
    for (uint32_t bit = 0; bit < MASK_BITS; ++bit)
        if (mask >> bit & 1u)
            out.semantic[out.count++] = semantic_of_bit(bit);
    return out;
}

static uint32_t bit_count(uint32_t mask)
{
    uint32_t count = 0;
    for (; mask; mask &= mask - 1)
        count += 1;
    return count;
}

static uint32_t mask_of_count(uint32_t count)
{
    return count == 22 ? GLOVE_MASK_22 : count == 18 ? GLOVE_MASK_18 : 0;
}

void glove_sensors_of_count(uint32_t count, glove_sensors *out)
{
    *out = of_mask(mask_of_count(count));
}

/* The low byte comes first, unless the mask of 18 sensors shows the other order. */
static uint32_t in_order(uint32_t mask)
{
    uint32_t turned = (mask & 0xFFu) << 16 | (mask & 0xFF00u) | mask >> 16;
    return turned == GLOVE_MASK_18 ? turned : mask;
}

/* Returns the hardware mask, unless it contradicts the sensor count of known gloves. */
static uint32_t hardware_mask(const glove_reported *census)
{
    uint32_t mask = in_order(census->hardware_mask & 0xFFFFFFu);
    uint32_t usual = mask_of_count(census->sensor_count);
    return usual && bit_count(mask) != census->sensor_count ? usual : mask;
}

bool glove_sensors_find(const glove_reported *census, glove_sensors *out)
{
    uint32_t mask = hardware_mask(census);
    uint32_t sent_mask = mask & in_order(census->software_mask & 0xFFFFFFu);
    if (sent_mask)
        mask = sent_mask;
    if (!mask)
        return false;
    *out = of_mask(mask);
    if (census->sent_count > 0 && census->sent_count < out->count)
        out->count = census->sent_count;
    return true;
}
