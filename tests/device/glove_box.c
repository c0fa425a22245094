#include "glove_box.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    CTRL_C = 0x03,
    CTRL_I = 0x09,
    CTRL_R = 0x12,
    NO_SENSOR_BIT = 7,  /* the index finger has no abduction sensor */
    MASK_18 = 0x7BBB3F, /* bit 4 * finger + joint; the carpus counts as a finger */
    MASK_22 = 0x7FFF7F,
    MASK_BITS = 23,
    STATUS_GLOVE_IN = 1 << 0,
    STATUS_SWITCH = 1 << 1,
    STATUS_LIGHT = 1 << 2,
    STATUS_ALWAYS = 1 << 7,
    VARIABLE = -1
};

void glove_box_init(glove_box *box, const glove_model *model)
{
    uint32_t mask = model->sensor_count == 18 ? MASK_18 : MASK_22;
    *box = (glove_box){.model = *model,
                       .filter = true,
                       .switch_lights = true,
                       .hardware_mask = mask,
                       .software_mask = mask,
                       .sent_count = model->sensor_count,
                       .period_word = {1152, 0},
                       .baud = model->baud};
}

int64_t glove_box_period_ns(const glove_box *box)
{
    uint64_t ticks = (uint64_t)box->period_word[0] * box->period_word[1];
    if (ticks == 0 || box->model.flavour == GLOVE_CG2)
        return 1000000000 / (int64_t)box->model.native_hz;
    return (int64_t)(ticks * 1000000000u / GLOVE_TICKS_PER_S);
}

/* ---- replies ---- */

static void put(glove_reply *out, uint8_t byte)
{
    if (out->size < GLOVE_REPLY_MAX)
        out->bytes[out->size++] = byte;
}

static void put_text(glove_reply *out, const char *text)
{
    while (*text)
        put(out, (uint8_t)*text++);
}

__attribute__((format(printf, 2, 3))) static void put_format(glove_reply *out, const char *format,
                                                             ...)
{
    char text[GLOVE_REPLY_MAX];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    put_text(out, text);
}

/* An error's name ends like any reply: "e?", unknown; "en", bad number. */
static void refuse(const glove_box *box, glove_reply *out, char kind)
{
    if (box->model.flavour == GLOVE_CG2)
        put_text(out, " e?\r\n");
    else
        put_format(out, "e%c", kind);
    put(out, 0);
    out->action = GLOVE_ANSWER;
}

static void confirm(glove_reply *out, uint8_t letter)
{
    put(out, letter);
    put(out, 0);
    out->action = GLOVE_ANSWER;
}

static void control(glove_box *box, uint8_t byte, glove_reply *out)
{
    box->pending_size = 0;
    put(out, byte);
    if (byte == CTRL_R) {
        glove_model model = box->model;
        glove_box_init(box, &model);
        if (model.flavour == GLOVE_CG1)
            put_text(out, "\r\n");
    }
    put(out, 0);
    out->action = byte == CTRL_C ? GLOVE_STOP : byte == CTRL_R ? GLOVE_RESTART : GLOVE_ANSWER;
}

/* ---- flags, numbers and masks, set and asked ---- */

static bool *flag_of(glove_box *box, char letter)
{
    switch (letter) {
    case 'D':
        return &box->stamp;
    case 'U':
        return &box->status;
    case 'F':
        return &box->filter;
    case 'J':
        return &box->switch_lights;
    case 'L':
        return &box->light;
    case 'W':
        return &box->wrist_switch;
    case 'Q':
        return &box->quantised;
    default:
        return NULL;
    }
}

static bool is_offered(const glove_box *box, char letter)
{
    return box->model.flavour == GLOVE_CG1 || !strchr("DNTBQ", letter);
}

static uint32_t word_of(const uint8_t *byte, bool is_little_end)
{
    return is_little_end ? (uint32_t)byte[1] << 8 | byte[0] : (uint32_t)byte[0] << 8 | byte[1];
}

static uint32_t mask_of(const uint8_t *byte)
{
    return (uint32_t)byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16;
}

static void put_mask(glove_reply *out, uint32_t mask)
{
    for (int i = 0; i < 3; ++i)
        put(out, (uint8_t)(mask >> 8 * i));
}

static uint8_t status_byte(const glove_box *box)
{
    bool is_lit = box->switch_lights ? box->wrist_switch : box->light;
    return (uint8_t)(STATUS_ALWAYS | (box->is_unplugged ? 0 : STATUS_GLOVE_IN) |
                     (box->wrist_switch ? STATUS_SWITCH : 0) | (is_lit ? STATUS_LIGHT : 0));
}

/* Byte 1 of the parameter flags. */
enum { P_STATUS = 1 << 2, P_LIGHT = 1 << 3, P_FILTER = 1 << 4, P_STAMP = 1 << 5 };
enum { P_RIGHT = 1 << 6, P_VALID = 1 << 7 };

static void put_parameter_flags(const glove_box *box, glove_reply *out)
{
    put(out, status_byte(box));
    put(out, (uint8_t)((box->status ? P_STATUS : 0) | (box->switch_lights ? P_LIGHT : 0) |
                       (box->filter ? P_FILTER : 0) | (box->stamp ? P_STAMP : 0) |
                       (box->model.is_right ? P_RIGHT : 0) | P_VALID));
    put(out, box->quantised ? 1 : 0);
}

static void take_parameter_flags(glove_box *box, const uint8_t *byte)
{
    box->status = byte[1] & P_STATUS;
    box->switch_lights = byte[1] & P_LIGHT;
    box->filter = byte[1] & P_FILTER;
    box->stamp = (byte[1] & P_STAMP) && box->model.flavour == GLOVE_CG1;
    box->quantised = byte[2] & 1;
}

/* The rate is 115200 / {1, 3, 4, 13} / 2^n. */
static uint32_t baud_of(uint8_t byte)
{
    static const uint32_t divisor[] = {1, 3, 4, 13};
    return 115200u / divisor[byte >> 4 & 3] >> (byte & 7);
}

static bool set_period(glove_box *box, uint32_t first, uint32_t second)
{
    if (first == 0 || first > 65535 || second > 65535)
        return false;
    box->period_word[0] = first;
    box->period_word[1] = second;
    return true;
}

/* ---- upper case: binary parameters ---- */

static size_t parameter_bytes(char letter)
{
    return letter == 'T'                    ? 4
           : letter == 'M' || letter == 'P' ? 3
           : strchr("DUFJLWQNB", letter)    ? 1
                                            : 0;
}

static bool obey(glove_box *box, char letter, const uint8_t *parameter)
{
    bool *flag = flag_of(box, letter);
    if (flag) {
        if (parameter[0] > 1)
            return false;
        *flag = parameter[0] == 1;
        return true;
    }
    switch (letter) {
    case 'M':
        box->software_mask = mask_of(parameter);
        return true;
    case 'N':
        if (parameter[0] > box->model.sensor_count)
            return false;
        box->sent_count = parameter[0];
        return true;
    case 'P':
        take_parameter_flags(box, parameter);
        return true;
    case 'T':
        return set_period(box, word_of(parameter, box->model.has_little_end_words),
                          word_of(parameter + 2, box->model.has_little_end_words));
    default: /* 'B' */
        box->baud_byte = parameter[0];
        box->baud = baud_of(parameter[0]);
        return true;
    }
}

static void ask(glove_box *box, char letter, glove_reply *out)
{
    const bool *flag = flag_of(box, letter);
    if (!strchr("SKMNRGUDFJLWPTBV", letter) ||
        (box->model.flavour == GLOVE_CG2 && strchr("BDN", letter))) {
        refuse(box, out, '?');
        return;
    }
    put(out, '?');
    put(out, (uint8_t)letter);
    if (flag)
        put(out, *flag ? 1 : 0);
    else if (letter == 'S')
        put(out, (uint8_t)box->model.sensor_count);
    else if (letter == 'K')
        put_mask(out, box->hardware_mask);
    else if (letter == 'M')
        put_mask(out, box->software_mask);
    else if (letter == 'N')
        put(out, (uint8_t)box->sent_count);
    else if (letter == 'R')
        put(out, box->model.is_right ? 1 : 0);
    else if (letter == 'G')
        put(out, box->is_unplugged ? 1 : 3);
    else if (letter == 'P')
        put_parameter_flags(box, out);
    else if (letter == 'B')
        put(out, box->baud_byte);
    else if (letter == 'V')
        put_text(out, box->model.flavour == GLOVE_CG1 ? "1.50" : "3.01");
    else /* 'T' */
        for (int i = 0; i < 2; ++i) {
            uint32_t word = box->model.flavour == GLOVE_CG1 ? box->period_word[i] : 0;
            uint8_t low = (uint8_t)word, high = (uint8_t)(word >> 8);
            put(out, box->model.has_little_end_words ? low : high);
            put(out, box->model.has_little_end_words ? high : low);
        }
    put(out, 0);
    out->action = GLOVE_ANSWER;
}

/* ---- lower case: the same in decimal numbers ---- */

static void ask_in_ascii(glove_box *box, char letter, glove_reply *out)
{
    if (letter == 'v' || letter == 'i' || letter == 'c') {
        put_format(out, "?%c %s\r\n", letter,
                   letter == 'v'   ? "CyberGlove 1.50"
                   : letter == 'i' ? "An emulated CyberGlove. Nothing is inside."
                                   : "0 0 0");
        put(out, 0);
        out->action = GLOVE_ANSWER;
        return;
    }
    glove_reply binary = {0};
    ask(box, (char)toupper(letter), &binary);
    if (binary.bytes[0] != '?') {
        *out = binary;
        return;
    }
    put_format(out, "?%c", letter);
    if (letter == 't')
        put_format(out, " %u %u", word_of(binary.bytes + 2, box->model.has_little_end_words),
                   word_of(binary.bytes + 4, box->model.has_little_end_words));
    else
        for (size_t i = 2; i + 1 < binary.size; ++i)
            put_format(out, " %u", binary.bytes[i]);
    put_text(out, "\r\n");
    put(out, 0);
    out->action = GLOVE_ANSWER;
}

/* "t 768 1" without its CR; false: a bad number. */
static bool obey_in_ascii(glove_box *box, char letter, const char *text)
{
    unsigned long number[4] = {0};
    size_t count = 0;
    for (char *end; count < 4; ++count, text = end) {
        number[count] = strtoul(text, &end, 10);
        if (end == text)
            break;
    }
    char upper = (char)toupper(letter);
    if (upper == 'T')
        return count == 2 && set_period(box, (uint32_t)number[0], (uint32_t)number[1]);
    uint8_t parameter[4];
    for (size_t i = 0; i < count; ++i) {
        if (number[i] > 255)
            return false;
        parameter[i] = (uint8_t)number[i];
    }
    return count == parameter_bytes(upper) && obey(box, upper, parameter);
}

/* A whole line in pending[]: letter, blanks, numbers or '?'. */
static void obey_line(glove_box *box, glove_reply *out)
{
    char letter = (char)box->pending[0];
    box->pending[box->pending_size] = 0;
    const char *text = (const char *)box->pending + 1;
    if (!is_offered(box, (char)toupper(letter)))
        refuse(box, out, '?');
    else if (strchr(text, '?'))
        ask_in_ascii(box, letter, out);
    else if (!obey_in_ascii(box, letter, text))
        refuse(box, out, 'n');
    else
        confirm(out, (uint8_t)letter);
}

/* ---- commands ---- */

static void send_records(glove_reply *out, uint8_t letter)
{
    out->head = letter;
    out->action = letter == 'G' || letter == 'g' ? GLOVE_RECORD : GLOVE_STREAM;
}

static void say_voltage(glove_reply *out)
{
    put_text(out, "7445Volts\r\n");
    put(out, 0);
    out->action = GLOVE_ANSWER;
}

/* True once pending[] holds a command that was dealt with. */
static bool deal_with(glove_box *box, glove_reply *out)
{
    char letter = (char)box->pending[0];
    size_t size = box->pending_size;
    char upper = (char)toupper((unsigned char)letter);
    if (letter && strchr("GSgs", letter)) {
        send_records(out, (uint8_t)letter);
        return true;
    }
    if (letter == '?') {
        if (size < 2)
            return false;
        char about = (char)box->pending[1];
        if (islower((unsigned char)about))
            ask_in_ascii(box, about, out);
        else
            ask(box, about ? about : ' ', out);
        return true;
    }
    if (letter == 'V' && box->model.flavour == GLOVE_CG2) {
        say_voltage(out);
        return true;
    }
    bool is_known = letter && strchr("DUFJLWQNBMPT", upper) != NULL;
    if (!is_known || (box->model.refuses_each_byte && !is_offered(box, upper))) {
        refuse(box, out, '?');
        return true;
    }
    if (islower((unsigned char)letter)) {
        bool is_whole = box->pending[size - 1] == '\r';
        if (!is_whole && size + 1 < sizeof box->pending)
            return false;
        obey_line(box, out);
        return true;
    }
    if (size < 1 + parameter_bytes(letter))
        return false;
    if (!is_offered(box, letter))
        refuse(box, out, '?');
    else if (obey(box, letter, box->pending + 1))
        confirm(out, (uint8_t)letter);
    else
        refuse(box, out, 'n');
    return true;
}

/* A binary parameter may have the value of any control character but Ctrl-C, which always aborts.
 */
static bool is_parameter(const glove_box *box)
{
    return box->pending_size > 0 && isupper(box->pending[0]);
}

void glove_box_receive(glove_box *box, uint8_t byte, glove_reply *out)
{
    *out = (glove_reply){0};
    bool is_control = byte == CTRL_I || byte == CTRL_R;
    if (byte == CTRL_C ? !(is_parameter(box) && strchr("MNPTB", box->pending[0]))
                       : is_control && !is_parameter(box)) {
        control(box, byte, out);
        return;
    }
    if (box->pending_size == 0 && (byte == '\r' || byte == '\n'))
        return;
    box->pending[box->pending_size++] = byte;
    if (deal_with(box, out))
        box->pending_size = 0;
}

/* ---- records ---- */

uint32_t glove_box_sent(const glove_box *box, uint32_t *out_sensor)
{
    uint32_t count = 0;
    for (uint32_t bit = 0; bit < MASK_BITS && count < box->sent_count; ++bit)
        if (box->hardware_mask & box->software_mask & 1u << bit)
            out_sensor[count++] = bit < NO_SENSOR_BIT ? bit : bit - 1;
    return count;
}

/* A zero byte is sent as 1, and its flag says so: zeros end records. */
static size_t put_stamp(const glove_box *box, uint32_t tick, uint8_t *out)
{
    out[0] = box->model.has_bare_stamp_flags ? 0 : 0x80;
    for (int i = 0; i < 4; ++i) {
        uint8_t byte = (uint8_t)(tick >> 8 * i);
        out[1 + i] = byte ? byte : 1;
        out[0] = (uint8_t)(out[0] | (byte ? 0 : 1 << i));
    }
    return 5;
}

static size_t put_marks(unsigned marks, uint8_t *out)
{
    size_t size = 0;
    if (marks & GLOVE_MARK_FAST) {
        out[size++] = 'e';
        out[size++] = 's';
    }
    if (marks & GLOVE_MARK_UNPLUGGED) {
        out[size++] = 'e';
        out[size++] = 'g';
    }
    return size;
}

/* "g 90 59 50 ... \r\n" */
static size_t ascii_record(const glove_box *box, uint8_t head, const uint8_t *value, uint32_t count,
                           uint32_t tick, unsigned marks, uint8_t *out)
{
    char text[GLOVE_RECORD_MAX];
    int size = snprintf(text, sizeof text, "%c", head);
    for (uint32_t i = 0; i < count; ++i)
        size += snprintf(text + size, sizeof text - (size_t)size, " %u", value[i]);
    if (box->stamp)
        size += snprintf(text + size, sizeof text - (size_t)size, " %u", tick);
    if (box->status)
        size += snprintf(text + size, sizeof text - (size_t)size, " %u", status_byte(box));
    size += snprintf(text + size, sizeof text - (size_t)size, " %s%s\r\n",
                     marks & GLOVE_MARK_FAST ? "es" : "", marks & GLOVE_MARK_UNPLUGGED ? "eg" : "");
    memcpy(out, text, (size_t)size + 1);
    return (size_t)size + 1;
}

size_t glove_box_record(const glove_box *box, uint8_t head, const uint8_t *sensor, uint32_t tick,
                        unsigned marks, uint8_t *out)
{
    uint32_t sent[GLOVE_SENSORS];
    uint8_t value[GLOVE_SENSORS];
    uint32_t count = glove_box_sent(box, sent);
    for (uint32_t i = 0; i < count; ++i)
        value[i] = sensor[sent[i]] ? sensor[sent[i]] : 1;
    if (islower(head))
        return ascii_record(box, head, value, count, tick, marks, out);
    size_t size = 0;
    out[size++] = head;
    memcpy(out + size, value, count);
    size += count;
    if (box->stamp)
        size += put_stamp(box, tick, out + size);
    if (box->status)
        out[size++] = status_byte(box);
    size += put_marks(marks, out + size);
    out[size++] = 0;
    return size;
}
