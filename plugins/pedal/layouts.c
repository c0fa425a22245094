#include "layouts.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- the table ---- */

/* One bit of a byte; a byte that is 0 or 1; one of two keys. */
#define BIT(byte, n)     .bit = 8 * (byte) + (n), .width = 1, .up = 0, .down = 1
#define BYTE(byte)       .bit = 8 * (byte), .width = 8, .up = 0, .down = 1
#define KEY(code, other) .kind = LAYOUT_KEY, .key = {(code), (other)}

#define DEVICE(id_vendor, id_product)                                                              \
    .source = LAYOUT_OF_TABLE, .vendor = (id_vendor), .product = (id_product)

/* Interface 0, "01 modifiers 00 k k k k k": factory keys a b c, or the codes 1 2 3. The Linux
 * programming tools set these codes to keep letters free. */
#define PCSENSOR(id_vendor, id_product)                                                            \
    DEVICE(id_vendor, id_product), .interface_number = 0, .key_report_id = 1, .key_at = 3,         \
                                   .key_count = 5, .switch_count = 3,                              \
                                   .switches = {{.name = "left", KEY(4, 1)},                       \
                                                {.name = "centre", KEY(5, 2)},                     \
                                                {.name = "right", KEY(6, 3)}}

/* A boot keyboard, "modifiers 00 k k k k k k", with unknown keys: any key is the one switch. */
#define KEYBOARD(id_vendor, id_product)                                                            \
    DEVICE(id_vendor, id_product), .interface_number = LAYOUT_ANY, .key_at = 2, .key_count = 6,    \
                                   .any_key = true, .switch_count = 1,                             \
                                   .switches = {{.name = "any key", KEY(0, 0)}}

#define OLYMPUS(id_product)                                                                        \
    DEVICE(0x07b4, id_product), .interface_number = LAYOUT_ANY, .endpoint = 0x83,                  \
                                .switch_count = 3,                                                 \
                                .switches = {{.name = "left", BIT(2, 3)},                          \
                                             {.name = "middle", BIT(2, 1)},                        \
                                             {.name = "right", BIT(2, 2)}}

#define PHILIPS(id_product)                                                                        \
    DEVICE(0x0911, id_product), .interface_number = LAYOUT_ANY, .switch_count = 4,                 \
                                .switches = {{.name = "rewind", BIT(0, 0)},                        \
                                             {.name = "play", BIT(0, 1)},                          \
                                             {.name = "forward", BIT(0, 2)},                       \
                                             {.name = "end of letter", BIT(0, 3)}}

/* Axes from the report descriptor; `skip` axes come before those of the pedals. */
#define DESCRIBED(id_vendor, id_product, skip)                                                     \
    .source = LAYOUT_OF_DESCRIPTOR, .vendor = (id_vendor), .product = (id_product),                \
    .interface_number = LAYOUT_ANY, .axis_skip = (skip)

static const layout table[] = {
    {.name = "VEC USB Footpedal",
     DEVICE(0x05f3, 0x00ff),
     .interface_number = LAYOUT_ANY,
     .switch_count = 3,
     .switches = {{.name = "left", BIT(0, 0)},
                  {.name = "centre", BIT(0, 1)},
                  {.name = "right", BIT(0, 2)}}},
    {.name = "PCsensor FootSwitch", PCSENSOR(0x0c45, 0x7403)},
    {.name = "PCsensor FootSwitch", PCSENSOR(0x0c45, 0x7404)},
    {.name = "PCsensor FootSwitch", PCSENSOR(0x413d, 0x2107)},
    {.name = "PCsensor FootSwitch", PCSENSOR(0x1a86, 0xe026)},
    {.name = "PCsensor FootSwitch", PCSENSOR(0x3553, 0xb001)},
    {.name = "Olympus RS-26", OLYMPUS(0x0202)},
    {.name = "Olympus RS-28", OLYMPUS(0x0218)},
    {.name = "Philips ACC2310/2320", PHILIPS(0x1844)},
    {.name = "Philips ACC2330", PHILIPS(0x091a)},
    {.name = "X-keys XK-3 foot pedal",
     DEVICE(0x05f3, 0x042c),
     .interface_number = LAYOUT_ANY,
     .head = {0, 1},
     .head_count = 2,
     .switch_count = 3,
     .switches = {{.name = "left", BIT(2, 1)},
                  {.name = "middle", BIT(2, 2)},
                  {.name = "right", BIT(2, 3)}}},
    {.name = "Elgato Stream Deck Pedal",
     DEVICE(0x0fd9, 0x0086),
     .interface_number = LAYOUT_ANY,
     .switch_count = 3,
     .switches = {{.name = "left", BYTE(4)},
                  {.name = "middle", BYTE(5)},
                  {.name = "right", BYTE(6)}}},
    {.name = "Scythe USB Foot Switch", KEYBOARD(0x0426, 0x3011)},
    {.name = "Scythe USB Foot Switch", KEYBOARD(0x055a, 0x0998)},
    {.name = "FS1-P foot switch", KEYBOARD(0x5131, 0x2019)},
    {.name = "Logitech RS50 pedals", DESCRIBED(0x046d, 0xc276, 1)}, /* after the wheel */
    {.name = "CH Pro Pedals", DESCRIBED(0x068e, 0x0501, 0)},
    {.name = "OpenSimHardware pedals", DESCRIBED(0x1209, 0x3100, 0)},
    {.name = "EffigyLabs pedal", DESCRIBED(0x1209, 0xeffe, 0)},
};

const layout *layouts_table(size_t *out_count)
{
    *out_count = sizeof table / sizeof *table;
    return table;
}

const layout *layouts_find(uint16_t vendor, uint16_t product)
{
    for (size_t i = 0; i < sizeof table / sizeof *table; ++i)
        if (table[i].vendor == vendor && table[i].product == product)
            return &table[i];
    return NULL;
}

bool layout_is_analogue(const layout_switch *s)
{
    int64_t way = (int64_t)s->down - s->up;
    return s->kind == LAYOUT_FIELD && (way > 1 || way < -1);
}

/* ---- as text ---- */

/* Format of a layout, one item per line:
 *
 *   marotte pedal layout 1
 *   device 05f3:00ff VEC USB Footpedal
 *   interface any                          or its number
 *   endpoint any                           or its address with the direction bit: 0x81
 *   keys 1 3 5                             only a keyboard: report number (0: none), first byte of
 *                                          the list of keys, its length
 *   field 0 0 1 unsigned 0 1 left          report number, first bit, bits, values up and down, name
 *   key 4 left                             a key by its usage in HID page 7
 *
 * `field` and `key` lines are the switches in order, 1 to 4 of them. Empty lines and lines that
 * begin with # are comments. */

enum { LINE = 160 };

typedef struct reader {
    layout *out;
    char *reason;
    uint32_t line;
    bool has_header, has_device, has_interface, has_endpoint, has_keys, needs_keys;
} reader;

static mrt_result refuse(const reader *self, const char *what)
{
    snprintf(self->reason, LAYOUT_TEXT_REASON, "line %u: %s", self->line, what);
    return MRT_ERR_FORMAT;
}

/* ---- words and numbers ---- */

/* Removes the next word from *rest and terminates it; NULL: none. */
static char *next_word(char **rest)
{
    char *word = *rest + strspn(*rest, " ");
    if (*word == '\0')
        return NULL;
    char *end = word + strcspn(word, " ");
    *rest = *end ? end + 1 : end;
    *end = '\0';
    return word;
}

static bool parse_number(const char *word, int base, long low, long high, long *out)
{
    static const char *const digits[] = {"0123456789", "0123456789abcdef"};
    if (!word)
        return false;
    const char *first = word + (base == 10 && *word == '-');
    if (*first == '\0' || strlen(first) > 10 || strspn(first, digits[base == 16]) != strlen(first))
        return false;
    *out = strtol(word, NULL, base);
    return *out >= low && *out <= high;
}

/* Reads the rest of a line as a name: printable characters of any language, no control
 * characters. */
static bool take_name(char *out, size_t capacity, const char *rest)
{
    rest += strspn(rest, " ");
    size_t length = strlen(rest);
    if (length == 0 || length >= capacity)
        return false;
    memcpy(out, rest, length + 1);
    return true;
}

/* ---- lines ---- */

static mrt_result take_header(reader *self, const char *line)
{
    if (strcmp(line, "marotte pedal layout 1") != 0)
        return refuse(self, "expected \"marotte pedal layout 1\"");
    self->has_header = true;
    return MRT_OK;
}

static mrt_result take_device(reader *self, char *rest)
{
    char *word = next_word(&rest);
    long vendor, product;
    if (self->has_device || !word || strlen(word) != 9 || word[4] != ':')
        return refuse(self, "expected one line \"device VVVV:PPPP NAME\", four hex digits each");
    word[4] = '\0';
    if (!parse_number(word, 16, 0, UINT16_MAX, &vendor) ||
        !parse_number(word + 5, 16, 0, UINT16_MAX, &product))
        return refuse(self, "expected \"device VVVV:PPPP NAME\", lower-case hex digits");
    if (!take_name(self->out->name, LAYOUT_NAME, rest))
        return refuse(self, "expected the device's name, 1 to 63 bytes");
    self->out->vendor = (uint16_t)vendor;
    self->out->product = (uint16_t)product;
    self->has_device = true;
    return MRT_OK;
}

static mrt_result take_interface(reader *self, char *rest)
{
    char *word = next_word(&rest);
    long number = LAYOUT_ANY;
    bool is_any = word && strcmp(word, "any") == 0;
    if (self->has_interface || next_word(&rest) ||
        (!is_any && !parse_number(word, 10, 0, LAYOUT_ANY - 1, &number)))
        return refuse(self, "expected one line \"interface any\" or \"interface 0\" to 254");
    self->out->interface_number = (uint8_t)number;
    self->has_interface = true;
    return MRT_OK;
}

static mrt_result take_endpoint(reader *self, char *rest)
{
    char *word = next_word(&rest);
    long number = 0;
    bool is_any = word && strcmp(word, "any") == 0;
    bool is_hex = word && strncmp(word, "0x", 2) == 0;
    if (self->has_endpoint || next_word(&rest) ||
        (!is_any && (!is_hex || !parse_number(word + 2, 16, 0x81, 0x8f, &number))))
        return refuse(self, "expected one line \"endpoint any\" or \"endpoint 0x81\" to 0x8f");
    self->out->endpoint = (uint8_t)number;
    self->has_endpoint = true;
    return MRT_OK;
}

static mrt_result take_keys(reader *self, char *rest)
{
    long report_id, at, count;
    if (self->has_keys || !parse_number(next_word(&rest), 10, 0, 255, &report_id) ||
        !parse_number(next_word(&rest), 10, 0, 255, &at) ||
        !parse_number(next_word(&rest), 10, 1, 255, &count) || next_word(&rest))
        return refuse(self, "expected one line \"keys REPORT FIRST_BYTE COUNT\", 0 to 255");
    self->out->key_report_id = (uint8_t)report_id;
    self->out->key_at = (uint8_t)at;
    self->out->key_count = (uint8_t)count;
    self->has_keys = true;
    return MRT_OK;
}

static mrt_result add_switch(reader *self, layout_switch s, const char *rest)
{
    if (self->out->switch_count == LAYOUT_SWITCHES)
        return refuse(self, "more than 4 switches");
    if (!take_name(s.name, LAYOUT_SWITCH_NAME, rest))
        return refuse(self, "expected the switch's name, 1 to 23 bytes");
    self->out->switches[self->out->switch_count++] = s;
    return MRT_OK;
}

static mrt_result take_field(reader *self, char *rest)
{
    long report_id, bit, width, up, down;
    if (!parse_number(next_word(&rest), 10, 0, 255, &report_id) ||
        !parse_number(next_word(&rest), 10, 0, 8191, &bit) ||
        !parse_number(next_word(&rest), 10, 1, 32, &width))
        return refuse(self, "expected \"field REPORT FIRST_BIT BITS ...\"");
    const char *sign = next_word(&rest);
    if (!sign || (strcmp(sign, "signed") != 0 && strcmp(sign, "unsigned") != 0))
        return refuse(self, "expected signed or unsigned after the number of bits");
    if (!parse_number(next_word(&rest), 10, INT32_MIN, INT32_MAX, &up) ||
        !parse_number(next_word(&rest), 10, INT32_MIN, INT32_MAX, &down) || up == down)
        return refuse(self, "expected two different values: one for up and one for down");
    return add_switch(self,
                      (layout_switch){.report_id = (uint8_t)report_id,
                                      .bit = (uint16_t)bit,
                                      .width = (uint8_t)width,
                                      .is_signed = strcmp(sign, "signed") == 0,
                                      .up = (int32_t)up,
                                      .down = (int32_t)down},
                      rest);
}

static mrt_result take_key(reader *self, char *rest)
{
    long usage;
    if (!parse_number(next_word(&rest), 10, 1, 255, &usage))
        return refuse(self, "expected \"key USAGE NAME\", usage 1 to 255");
    self->needs_keys = true;
    return add_switch(self, (layout_switch){.kind = LAYOUT_KEY, .key = {(uint8_t)usage}}, rest);
}

static mrt_result take_line(reader *self, char *line)
{
    if (line[0] == '\0' || line[0] == '#')
        return MRT_OK;
    if (!self->has_header)
        return take_header(self, line);
    static const struct {
        const char *word;
        mrt_result (*take)(reader *self, char *rest);
    } kinds[] = {{"device", take_device},     {"interface", take_interface},
                 {"endpoint", take_endpoint}, {"keys", take_keys},
                 {"field", take_field},       {"key", take_key}};
    char *rest = line;
    const char *word = next_word(&rest);
    for (size_t i = 0; word && i < sizeof kinds / sizeof *kinds; ++i)
        if (strcmp(word, kinds[i].word) == 0)
            return kinds[i].take(self, rest);
    return refuse(self, "expected device, interface, endpoint, keys, field or key");
}

/* Copies the next line without its end. Returns false if it is too long or contains control
 * characters. */
static bool copy_line(char out[LINE], const char **at, const char *end)
{
    size_t length = 0;
    bool is_good = true;
    for (; *at < end && **at != '\n'; ++*at) {
        unsigned char c = (unsigned char)**at;
        is_good = is_good && length < LINE - 1 && c >= ' ' && c != 0x7f;
        if (is_good)
            out[length++] = **at;
    }
    if (*at < end)
        ++*at;
    out[length] = '\0';
    return is_good;
}

static mrt_result check_whole(const reader *self)
{
    if (!self->has_header || !self->has_device || !self->has_interface || !self->has_endpoint)
        return refuse(self, "the header, device, interface or endpoint line is missing");
    if (self->out->switch_count == 0)
        return refuse(self, "no switches: expected field or key lines");
    if (self->needs_keys != self->has_keys)
        return refuse(self, "a keys line needs key lines, and key lines need a keys line");
    return MRT_OK;
}

mrt_result layout_text_parse(layout *out, const char *bytes, size_t size,
                             char reason[LAYOUT_TEXT_REASON])
{
    layout read = {.source = LAYOUT_OF_LEARNING};
    reader self = {.out = &read};
    self.reason = reason;
    mrt_result result = MRT_OK;
    const char *end = bytes + size;
    *out = (layout){0};
    for (const char *at = bytes; at < end && result >= 0;) {
        char line[LINE];
        self.line += 1;
        result = copy_line(line, &at, end)
                     ? take_line(&self, line)
                     : refuse(&self, "longer than 159 bytes, or contains control characters");
    }
    if (result >= 0)
        result = check_whole(&self);
    if (result >= 0)
        *out = read;
    return result;
}

/* ---- writing ---- */

typedef struct writer {
    char *out;
    size_t used;
} writer;

__attribute__((format(printf, 2, 3))) static void put(writer *self, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    int length =
        vsnprintf(self->out + self->used, LAYOUT_TEXT_BYTES - self->used, format, arguments);
    va_end(arguments);
    if (length > 0 && (size_t)length < LAYOUT_TEXT_BYTES - self->used)
        self->used += (size_t)length;
}

static void put_switch(writer *self, const layout_switch *s)
{
    if (s->kind == LAYOUT_KEY)
        put(self, "key %u %s\n", s->key[0], s->name);
    else
        put(self, "field %u %u %u %s %ld %ld %s\n", s->report_id, s->bit, s->width,
            s->is_signed ? "signed" : "unsigned", (long)s->up, (long)s->down, s->name);
}

size_t layout_text_print(char out[LAYOUT_TEXT_BYTES], const layout *from)
{
    writer self = {.used = 0};
    self.out = out;
    put(&self, "marotte pedal layout 1\ndevice %04x:%04x %s\n", from->vendor, from->product,
        from->name);
    if (from->interface_number == LAYOUT_ANY)
        put(&self, "interface any\n");
    else
        put(&self, "interface %u\n", from->interface_number);
    if (from->endpoint == 0)
        put(&self, "endpoint any\n");
    else
        put(&self, "endpoint 0x%02x\n", from->endpoint);
    bool has_key = false;
    for (uint32_t i = 0; i < from->switch_count; ++i)
        has_key = has_key || from->switches[i].kind == LAYOUT_KEY;
    if (has_key)
        put(&self, "keys %u %u %u\n", from->key_report_id, from->key_at, from->key_count);
    for (uint32_t i = 0; i < from->switch_count; ++i)
        put_switch(&self, &from->switches[i]);
    return self.used;
}

/* ---- storing in the user's folder ---- */

static bool folder_path(char out[LAYOUT_FILE_PATH])
{
    const char *config = getenv("XDG_CONFIG_HOME");
    const char *home = getenv("HOME");
    int length = -1;
    if (config && config[0] == '/') /* the specification requires ignoring relative paths */
        length = snprintf(out, LAYOUT_FILE_PATH, "%s/marotte/pedals", config);
    else if (home && home[0] == '/')
        length = snprintf(out, LAYOUT_FILE_PATH, "%s/.config/marotte/pedals", home);
    return length > 0 && length < LAYOUT_FILE_PATH - 32; /* space for a file name */
}

bool layout_file_path(char out[LAYOUT_FILE_PATH], uint16_t vendor, uint16_t product)
{
    if (!folder_path(out))
        return false;
    size_t used = strlen(out);
    snprintf(out + used, LAYOUT_FILE_PATH - used, "/%04x_%04x.layout", vendor, product);
    return true;
}

/* ---- reading ---- */

/* Reads up to one byte more than allowed, to detect a file that is too long. */
static ssize_t read_bounded(int file, char out[LAYOUT_TEXT_BYTES + 1])
{
    size_t used = 0;
    while (used <= LAYOUT_TEXT_BYTES) {
        ssize_t got = read(file, out + used, LAYOUT_TEXT_BYTES + 1 - used);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return -1;
        if (got == 0)
            break;
        used += (size_t)got;
    }
    return (ssize_t)used;
}

/* O_NONBLOCK: a pipe in place of the file must not block. */
static mrt_result read_file(const char *path, char *bytes, size_t *out_size, char *reason)
{
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (file < 0 && (errno == ENOENT || errno == ENOTDIR))
        return MRT_END;
    struct stat status;
    ssize_t size = -1;
    if (file >= 0 && fstat(file, &status) == 0) {
        if (S_ISREG(status.st_mode))
            size = read_bounded(file, bytes);
        else
            errno = EINVAL;
    }
    int why = errno;
    if (file >= 0)
        close(file);
    if (size < 0) {
        snprintf(reason, LAYOUT_FILE_REASON, "%s: %s: make the file readable, or remove it", path,
                 strerror(why));
        return MRT_ERR_IO;
    }
    if (size > LAYOUT_TEXT_BYTES) {
        snprintf(reason, LAYOUT_FILE_REASON,
                 "%s: longer than 4096 bytes, so not a layout: remove it", path);
        return MRT_ERR_FORMAT;
    }
    *out_size = (size_t)size;
    return MRT_OK;
}

mrt_result layout_file_load(layout *out, uint16_t vendor, uint16_t product,
                            char reason[LAYOUT_FILE_REASON])
{
    char path[LAYOUT_FILE_PATH], bytes[LAYOUT_TEXT_BYTES + 1], why[LAYOUT_TEXT_REASON];
    size_t size = 0;
    if (!layout_file_path(path, vendor, product))
        return MRT_END;
    mrt_result result = read_file(path, bytes, &size, reason);
    if (result != MRT_OK)
        return result;
    result = layout_text_parse(out, bytes, size, why);
    if (result >= 0 && (out->vendor != vendor || out->product != product)) {
        snprintf(why, sizeof why, "the layout is for device %04x:%04x", out->vendor, out->product);
        result = MRT_ERR_FORMAT;
    }
    if (result < 0)
        snprintf(reason, LAYOUT_FILE_REASON,
                 "%s: %s: correct the file, or remove it and teach the pedal again", path, why);
    return result;
}

/* ---- writing ---- */

static bool make_folders(char *path)
{
    for (char *c = path + 1; *c; ++c) {
        if (*c != '/')
            continue;
        *c = '\0';
        bool is_made = mkdir(path, 0755) == 0 || errno == EEXIST;
        *c = '/';
        if (!is_made)
            return false;
    }
    return true;
}

static bool write_all(int file, const char *bytes, size_t size)
{
    while (size > 0) {
        ssize_t done = write(file, bytes, size);
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return false;
        bytes += done;
        size -= (size_t)done;
    }
    return fsync(file) == 0;
}

static bool write_file(const char *path, const char *bytes, size_t size)
{
    char temporary[LAYOUT_FILE_PATH + 16];
    snprintf(temporary, sizeof temporary, "%s.XXXXXX", path);
    int file = mkstemp(temporary);
    if (file < 0)
        return false;
    bool is_good = write_all(file, bytes, size);
    int why = errno;
    is_good = close(file) == 0 && is_good;
    if (is_good && rename(temporary, path) == 0)
        return true;
    why = is_good ? errno : why;
    unlink(temporary);
    errno = why;
    return false;
}

mrt_result layout_file_store(const layout *from, char reason[LAYOUT_FILE_REASON])
{
    char path[LAYOUT_FILE_PATH], bytes[LAYOUT_TEXT_BYTES];
    if (!layout_file_path(path, from->vendor, from->product)) {
        snprintf(reason, LAYOUT_FILE_REASON,
                 "no folder for the layout: set HOME or XDG_CONFIG_HOME");
        return MRT_ERR_IO;
    }
    size_t size = layout_text_print(bytes, from);
    if (make_folders(path) && write_file(path, bytes, size))
        return MRT_OK;
    snprintf(reason, LAYOUT_FILE_REASON, "cannot write %s: %s", path, strerror(errno));
    return MRT_ERR_IO;
}
