#!/usr/bin/env bash
# Where what was opened or received could reach a library, a process or the terminal there is one
# function that it passes (CONTRIBUTING.md, "Threats"): nobody goes around it.
set -u
cd "$SOURCE_DIR" || exit 1
failed=0

# only PATTERN WHY FILES...: these files alone match, of the product's sources; and each of them does.
only() {
    local pattern=$1 why=$2 file
    shift 2
    while read -r file; do
        [[ " $* " = *" $file "* ]] && continue
        echo "$file: $why:"
        grep -nE "$pattern" "$file" | head -n 3
        failed=1
    done < <(grep -rlE "$pattern" core ui plugins rigs --include=*.c --include=*.cpp --include=*.h --include=*.hpp)
    for file in "$@"; do
        grep -qE "$pattern" "$file" || { echo "$file: is named in borders.sh for \"$pattern\", which it does not have"; failed=1; }
    done
}
word='(^|[^_[:alnum:]>.])'

# Libraries: of plugins by plugin_library_open alone (the checker has its own), of the system by their names.
only "${word}dlopen\(" "loads a library: plugins go through stage/mapping/plugins.h" \
    core/stage/mapping/plugins.c core/check/child/cases_library.c ui/draw/gl.c ui/window/gui/window.c
# A path to a plugin is what the person has just written: on the command line, or in the window.
only "plugin_list_(choose|choose_spec|add)\(" "opens a plugin by its path: what is stored is looked up by plugin_list_find" \
    core/stage/mapping/plugins.c core/stage/mapping/plugins.h ui/cli/calibrate.c ui/cli/devices.c \
    ui/cli/perform_session.c ui/window/app/app_main.c ui/window/app/app_open.c
# Processes: no shell, ever.
only "${word}(system|popen|execl|execlp|execle|execv|execvp|fork|vfork)\(" "starts a process through a shell or by fork" # nobody
only "${word}(posix_spawnp?|program_spawn)\(" "starts a process: see CONTRIBUTING.md" \
    core/base/program.c core/base/program.h core/check/check.c core/io/read/mesh_child.c core/stage/mapping/isolate_process.c ui/paper/paper_moai.c \
    plugins/openxr/openxr_helper.c ui/cli/take_export_all.c ui/stream/video.c ui/window/app/browser.c ui/window/app/camera_package.c ui/window/app/camera_page.c ui/window/app/exporter.c
# Beside posix_spawn: descriptors that children do not get, waits that end, nothing that is the whole process's.
only "${word}pipe\(" "is inherited by programs that start meanwhile: program_pipe" # nobody
only "waitpid\([^)]*, 0\)" "waits for ever: program_wait" # nobody
only "${word}(umask|setlocale|chdir|setenv|putenv)\(" "changes what is the whole process's" # nobody
exit $failed
