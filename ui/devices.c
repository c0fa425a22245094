/* marotte devices: what is plugged in, how it is doing, and passing it on. */
#include "devices.h"
#include "base/cancel.h"
#include "base/text.h"
#include "news.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static wake stop_wake; /* of whatever waits: inputs signal it too */

static void wake_up(void)
{
    wake_signal(&stop_wake);
}

enum { OPTION_JSON = 1, OPTION_WATCH, OPTION_INPUT, OPTION_SECONDS, OPTION_FORWARD, OPTION_LEARN };
static const struct option option_table[] = {
    {"json", no_argument, NULL, OPTION_JSON},
    {"watch", no_argument, NULL, OPTION_WATCH},
    {"input", required_argument, NULL, OPTION_INPUT},
    {"seconds", required_argument, NULL, OPTION_SECONDS},
    {"forward", required_argument, NULL, OPTION_FORWARD},
    {"learn", required_argument, NULL, OPTION_LEARN},
    {NULL, 0, NULL, 0},
};

static int add_input(devices_options *out, const char *text)
{
    if (out->input_count == DEVICES_INPUTS_MAX)
        return command_usage(&command_devices, "at most %d inputs are possible",
                             DEVICES_INPUTS_MAX);
    if (!spec_read(&out->input[out->input_count++], text))
        return command_usage(&command_devices, "--input \"%s\" is not PLUGIN[:ADDRESS][,key=value]",
                             text);
    return COMMAND_DONE;
}

static int set_learn(devices_options *out, const char *text)
{
    if (out->is_learn)
        return command_usage(&command_devices, "one --learn is possible");
    out->is_learn = true;
    if (!spec_read(&out->learn, text))
        return command_usage(&command_devices, "--learn \"%s\" is not PLUGIN[:ADDRESS][,key=value]",
                             text);
    return COMMAND_DONE;
}

static int set_seconds(devices_options *out, const char *text)
{
    if (text_double(text_view_of(text, strlen(text)), &out->seconds) && out->seconds >= 0.001 &&
        out->seconds <= 1e6)
        return COMMAND_DONE;
    return command_usage(&command_devices, "--seconds \"%s\" is not a number from 0.001 to 1e6",
                         text);
}

static int read_option(devices_options *out, int option, const char *text)
{
    switch (option) {
    case OPTION_JSON:
        out->is_json = true;
        return COMMAND_DONE;
    case OPTION_WATCH:
        out->is_watch = true;
        return COMMAND_DONE;
    case OPTION_INPUT:
        return add_input(out, text);
    case OPTION_SECONDS:
        return set_seconds(out, text);
    case OPTION_FORWARD:
        out->forward = text;
        out->is_watch = true;
        return COMMAND_DONE;
    case OPTION_LEARN:
        return set_learn(out, text);
    default:
        return COMMAND_USAGE;
    }
}

static int check_options(const devices_options *options)
{
    if (options->is_learn && (options->is_watch || options->input_count > 0))
        return command_usage(&command_devices, "--learn goes alone: it names its device");
    if (!options->is_watch && options->input_count > 0)
        return command_usage(&command_devices, "--input wants --watch or --forward");
    if (!options->is_watch && !options->is_learn && options->seconds > 0)
        return command_usage(&command_devices, "--seconds wants --watch, --forward or --learn");
    return COMMAND_DONE;
}

static int read_options(devices_options *out, int argc, char **argv)
{
    int code = COMMAND_DONE;
    opterr = 0;
    optind = 1;
    while (code == COMMAND_DONE) {
        int option = getopt_long(argc, argv, ":", option_table, NULL);
        if (option == -1)
            break;
        if (option == ':')
            code = command_usage(&command_devices, "%s needs a value", argv[optind - 1]);
        else if (option == '?')
            code = command_usage(&command_devices, "there is no option \"%s\"", argv[optind - 1]);
        else
            code = read_option(out, option, optarg);
    }
    if (code == COMMAND_DONE && optind < argc)
        code = command_usage(&command_devices, "\"%s\" is not expected here", argv[optind]);
    return code == COMMAND_DONE ? check_options(out) : code;
}

static void finish_options(devices_options *options)
{
    for (uint32_t i = 0; i < options->input_count; ++i)
        spec_finish(&options->input[i]);
    spec_finish(&options->learn);
}

static mrt_result list_devices(const devices_options *options, const plugin_list *plugins,
                               log_queue *log, error *err)
{
    device_list found;
    mrt_result result = device_list_look(&found, plugins, log, NULL, err);
    if (result < 0)
        return result;
    if (options->is_json)
        devices_print_json(&found, plugins);
    else
        devices_print(&found, plugins);
    return MRT_OK;
}

static mrt_result run_with(const devices_options *options, plugin_list *plugins, log_queue *log,
                           error *err)
{
    if (options->is_learn)
        return devices_learn(options, plugins, log, &stop_wake, cancel_flag(), err);
    if (options->is_watch)
        return devices_watch(options, plugins, log, &stop_wake, cancel_flag(), err);
    return list_devices(options, plugins, log, err);
}

static int run(int argc, char **argv)
{
    devices_options options = {.input_count = 0};
    plugin_list plugins = {0};
    error err = {""};
    int code = read_options(&options, argc, argv);
    if (code != COMMAND_DONE) {
        finish_options(&options);
        return code;
    }
    wake_init(&stop_wake);
    cancel_on_signals(CANCEL_WAITS, wake_up);
    log_queue *log = log_queue_create();
    mrt_result result =
        log ? plugin_list_load(&plugins, &err) : error_set(&err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0)
        result = run_with(&options, &plugins, log, &err);
    plugin_list_destroy(&plugins);
    news_print(log);
    log_queue_destroy(log);
    finish_options(&options);
    return result < 0 ? command_failed(&command_devices, &err) : COMMAND_DONE;
}

const command command_devices = {
    .name = "devices",
    .summary = "what is plugged in, how it is doing, and passing it on",
    .help = "marotte devices [--json]\n"
            "marotte devices --watch [--input SPEC]... [--seconds N] [--json]\n"
            "marotte devices --forward HOST:PORT [--input SPEC]... [--seconds N]\n"
            "marotte devices --learn PLUGIN[:ADDRESS] [--seconds N]\n"
            "\n"
            "Lists the gloves and pedals that are plugged in: what to write after --input, and\n"
            "what to do about those that cannot be used.\n"
            "\n"
            "  --watch          opens those that are ready and shows how they do: rate, jitter,\n"
            "                   lateness, samples lost, drift of the clock, sensors at the end of\n"
            "                   their range. What goes away or is plugged in later is waited for\n"
            "  --input SPEC     PLUGIN[:ADDRESS][,key=value]...: this one instead; up to 8 times\n"
            "  --seconds N      ends after so long (else with Ctrl-C)\n"
            "  --forward H:P    watches, and passes every sample on to the marotte that listens\n"
            "                   there with --input osc:0.0.0.0:PORT/SOURCE\n"
            "  --learn SPEC     asks for the switches of an unknown pedal and remembers them\n"
            "  --json           for machines; with --watch one line a second\n",
    .run = run,
};
