/* marotte plugin: which plugins there are, new ones, and whether they are right. */
#include "plugin.h"

#include <string.h>

static int run(int argc, char **argv)
{
    static const struct {
        const char *name;
        int (*run)(int argc, char **argv);
    } parts[] = {{"list", plugin_list_run}, {"new", plugin_new_run}, {"check", plugin_check_run}};
    if (argc < 2)
        return command_usage(&command_plugin, "say what to do: list, new or check");
    for (size_t i = 0; i < sizeof parts / sizeof *parts; ++i)
        if (strcmp(argv[1], parts[i].name) == 0)
            return parts[i].run(argc - 1, argv + 1);
    return command_usage(&command_plugin, "there is no \"%s\": list, new and check are possible",
                         argv[1]);
}

const command command_plugin = {
    .name = "plugin",
    .summary = "what plugins there are; a new one; whether one is right",
    .help =
        "marotte plugin list [--params] [--json]\n"
        "  The plugins that are loaded, from where, and those that are not, and why.\n"
        "\n"
        "  --params   with their parameters: group, name, range, unit (initial value)\n"
        "  --json     for machines\n"
        "\n"
        "  Plugins are looked for in $MAROTTE_PLUGIN_PATH (folders with ':' between them),\n"
        "  $XDG_DATA_HOME/marotte/plugins, the installed folder, and beside the program.\n"
        "\n"
        "marotte plugin new NAME --mapping|--input [--dir FOLDER]\n"
        "  Begins a plugin of your own: a folder NAME with a plugin that works, in one\n"
        "  commented C file, what builds it, what to do with it, and a recorded hand to try it\n"
        "  on. Says the next three commands.\n"
        "\n"
        "  --mapping  hands in, a face out\n"
        "  --input    where hands come from\n"
        "  --dir      where the folder is made (.)\n"
        "\n"
        "marotte plugin check FILE.so [--json] [--rules]\n"
        "                     [--input ADDRESS] [--output ADDRESS] [--seed N] [--repeat N]\n"
        "  Examines a plugin by every rule of <marotte/plugin.h> and explains what it breaks:\n"
        "  odd faces, odd hands, 100 000 frames at random, what it may not do in real time, the\n"
        "  same bits again. It runs in processes of its own. Exit code 1: a rule is broken.\n"
        "\n"
        "  --rules    lists the rules instead\n"
        "  --input    what an input is to open (the first that it finds)\n"
        "  --output   where an output is to send (nowhere)\n"
        "  --seed     of all that is random; as the last check said, to see the same again\n"
        "  --repeat   examines it so often, each time with the next seed\n"
        "  --json     for machines\n",
    .run = run,
};
