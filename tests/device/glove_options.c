#include "glove_options.h"

#include "base/clock.h"
#include "base/text.h"

#include <stdio.h>
#include <string.h>

typedef enum option_kind {
    OPTION_FLAG = 0,
    OPTION_NO, /* a flag that sets false */
    OPTION_COUNT,
    OPTION_NUMBER,
    OPTION_MS, /* kept in ns */
    OPTION_TEXT,
    OPTION_CHOICE, /* an enum: one of the words in `words`, from 0 up */
    OPTION_SET     /* bits: 1 << k for each of the words, separated by commas */
} option_kind;

typedef struct option {
    const char *name;
    option_kind kind;
    size_t offset; /* in glove_settings */
    const char *words;
    const char *help;
} option;

#define AT(member) offsetof(glove_settings, member)
static const option options[] = {
    {"sensors", OPTION_COUNT, AT(model.sensor_count), NULL, "18 or 22"},
    {"left", OPTION_NO, AT(model.is_right), NULL, "a left glove"},
    {"flavour", OPTION_CHOICE, AT(model.flavour), "cg1,cg2",
     "cg1: the interface unit; cg2: CyberGlove II and III, which refuse D, N, T"},
    {"native-hz", OPTION_COUNT, AT(model.native_hz), NULL, "records a second, unless T says so"},
    {"bare-stamp-flags", OPTION_FLAG, AT(model.has_bare_stamp_flags), NULL,
     "bit 7 of a time stamp's flags is clear, so that they may be 0"},
    {"refuses-each-byte", OPTION_FLAG, AT(model.refuses_each_byte), NULL,
     "a refused command's parameters are answered as commands"},
    {"little-end-words", OPTION_FLAG, AT(model.has_little_end_words), NULL, "in the binary T"},
    {"nature", OPTION_CHOICE, AT(nature), "glove,modem,echo,noise,mute",
     "what is at the end of the cable"},
    {"motion", OPTION_TEXT, AT(motion), NULL, "sweep, still, or a recording's file"},
    {"numbered", OPTION_FLAG, AT(is_numbered), NULL,
     "palm arch and wrist yaw count the records, in base 254"},
    {"truth", OPTION_TEXT, AT(truth), NULL, "file for what was measured when, and when sent"},
    {"control", OPTION_FLAG, AT(is_controlled), NULL,
     "obey lines on stdin: unplug, plug, silent, speak, quit"},
    {"seed", OPTION_COUNT, AT(seed), NULL, "of noise and spoiled bytes"},
    {"uptime-s", OPTION_NUMBER, AT(uptime_s), NULL, "what the glove's clock says at the start"},
    {"drift-ppm", OPTION_NUMBER, AT(drift_ppm), NULL, "how much the glove's clock is fast"},
    {"restart-ms", OPTION_MS, AT(restart_ns), NULL, "how long Ctrl-R takes"},
    {"switch-ms", OPTION_MS, AT(switch_ns), NULL, "the wrist switch is turned every so often"},
    {"streaming", OPTION_FLAG, AT(is_streaming), NULL, "a program that crashed has left it so"},
    {"link", OPTION_TEXT, AT(line.link), NULL, "a symbolic link to the terminal"},
    {"baud", OPTION_COUNT, AT(model.baud), NULL, "of the line"},
    {"unpaced", OPTION_NO, AT(line.is_paced), NULL, "bytes take no time"},
    {"minds-baud", OPTION_FLAG, AT(line.minds_baud), NULL,
     "a program at another rate reads and writes nonsense"},
    {"cooked", OPTION_FLAG, AT(line.is_cooked), NULL, "the terminal echoes until it is made raw"},
    {"latency-ms", OPTION_MS, AT(line.latency_ns), NULL, "latency timer of a USB adapter"},
    {"packet-bytes", OPTION_COUNT, AT(line.packet_bytes), NULL,
     "so many bytes do not wait for that timer (FTDI: 62)"},
    {"chunk-bytes", OPTION_COUNT, AT(line.chunk_bytes), NULL, "no write is longer"},
    {"spoil-every", OPTION_COUNT, AT(spoil_every), NULL, "of so many records one is spoiled"},
    {"spoil-kinds", OPTION_SET, AT(spoil_kinds), "none,zero,head,end,lost,twice",
     "how, in turn: a byte becomes 0; head or end is another; a byte is lost, or comes twice"},
    {"fast-every", OPTION_COUNT, AT(fast_every), NULL, "of so many records one is marked es"},
    {"unplugged-every", OPTION_COUNT, AT(unplugged_every), NULL,
     "of so many records some are marked eg, and their status says so"},
    {"unplugged-run", OPTION_COUNT, AT(unplugged_run), NULL, "so many in a row, instead of 1"},
    {"mute-from-command", OPTION_COUNT, AT(mute_from_command), NULL,
     "answers no more from the n-th command of a life on"},
    {"die-at-command", OPTION_COUNT, AT(die_at_command), NULL, "instead of answering the n-th"},
    {"silent-after", OPTION_COUNT, AT(silent_after), NULL, "records: stops"},
    {"cut-after", OPTION_COUNT, AT(cut_after), NULL, "records: stops within the next one"},
    {"noise-after", OPTION_COUNT, AT(noise_after), NULL, "records: streams nonsense"},
    {"die-after", OPTION_COUNT, AT(die_after), NULL, "records: the cable is pulled"},
    {"reset-after", OPTION_COUNT, AT(reset_after), NULL,
     "records: stops and forgets its settings, but answers"},
    {"fault-lives", OPTION_COUNT, AT(fault_lives), NULL, "only in the first n lives"},
    {"return-ms", OPTION_MS, AT(return_ns), NULL, "from a death to the next life"},
};
enum { OPTION_TOTAL = sizeof options / sizeof *options };

static const char *const value_names[] = {
    [OPTION_COUNT] = "N",   [OPTION_NUMBER] = "X", [OPTION_MS] = "MS",
    [OPTION_TEXT] = "TEXT", [OPTION_CHOICE] = "",  [OPTION_SET] = ""};

void glove_options_print(void)
{
    for (int i = 0; i < OPTION_TOTAL; ++i) {
        const option *o = &options[i];
        char left[64];
        const char *value = o->kind <= OPTION_NO ? "" : o->words ? o->words : value_names[o->kind];
        snprintf(left, sizeof left, "--%s %s", o->name, value);
        printf("  %-30s %s\n", left, o->help);
    }
}

/* Index of the word in "a,b,c", or -1. */
static int word_index(const char *words, text_view word)
{
    text_view rest = text_view_of(words, strlen(words)), one;
    for (int i = 0; text_next_field(&rest, ',', &one); ++i)
        if ((size_t)(one.end - one.at) == (size_t)(word.end - word.at) &&
            memcmp(one.at, word.at, (size_t)(one.end - one.at)) == 0)
            return i;
    return -1;
}

static bool set_words(const option *o, text_view value, void *member)
{
    unsigned bits = 0;
    text_view word;
    while (text_next_field(&value, ',', &word)) {
        int index = word_index(o->words, word);
        if (index < 0)
            return false;
        bits |= 1u << index;
    }
    memcpy(member, &bits, sizeof bits);
    return true;
}

static bool set_number(const option *o, text_view text, void *member)
{
    double number;
    if (!text_double(text, &number))
        return false;
    if (o->kind == OPTION_MS) {
        int64_t ns = (int64_t)(number * 1e6);
        memcpy(member, &ns, sizeof ns);
        return number >= 0 && number < 1e9;
    }
    memcpy(member, &number, sizeof number);
    return true;
}

static bool set_count(text_view text, void *member)
{
    int64_t number;
    if (!text_int(text, &number) || number < 0 || number > UINT32_MAX)
        return false;
    uint32_t count = (uint32_t)number;
    memcpy(member, &count, sizeof count);
    return true;
}

static bool set_option(const option *o, const char *value, glove_settings *settings)
{
    void *member = (char *)settings + o->offset;
    text_view text = text_view_of(value, strlen(value));
    switch (o->kind) {
    case OPTION_FLAG:
    case OPTION_NO:
        *(bool *)member = o->kind == OPTION_FLAG;
        return true;
    case OPTION_COUNT:
        return set_count(text, member);
    case OPTION_NUMBER:
    case OPTION_MS:
        return set_number(o, text, member);
    case OPTION_TEXT:
        memcpy(member, &value, sizeof value);
        return true;
    case OPTION_CHOICE: {
        unsigned index = (unsigned)word_index(o->words, text);
        memcpy(member, &index, sizeof index);
        return index != (unsigned)-1;
    }
    case OPTION_SET:
        return set_words(o, text, member);
    }
    return false;
}

mrt_result glove_options_read(const char *const *words, glove_settings *out, error *err)
{
    for (; *words; ++words) {
        const option *o = NULL;
        for (int k = 0; k < OPTION_TOTAL; ++k)
            if (strncmp(*words, "--", 2) == 0 && strcmp(*words + 2, options[k].name) == 0)
                o = &options[k];
        if (!o)
            return error_set(err, MRT_ERR_ARGUMENT, "%s: no such option (see --help)", *words);
        bool has_value = o->kind > OPTION_NO;
        if (has_value && !words[1])
            return error_set(err, MRT_ERR_ARGUMENT, "%s: expected a value", *words);
        const char *value = has_value ? *++words : "";
        if (!set_option(o, value, out))
            return error_set(err, MRT_ERR_ARGUMENT, "--%s: \"%s\" is not what is expected: %s",
                             o->name, value, o->words ? o->words : o->help);
    }
    if (out->model.sensor_count != 18 && out->model.sensor_count != 22)
        return error_set(err, MRT_ERR_ARGUMENT, "--sensors: 18 or 22");
    if (out->model.baud == 0 || out->model.native_hz == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "--baud and --native-hz: more than 0");
    return MRT_OK;
}
