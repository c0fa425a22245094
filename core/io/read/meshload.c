/* marotte-meshload FILE | --decode - runs readers of other libraries in a separate process with
 * little memory and time. With FILE it reads the file with OpenMesh and writes the mesh to standard
 * output (io/read/mesh_child.h). With --decode it runs the decoders of io/decode/decode.h on jobs
 * from standard input. Only io/read/mesh_child.c starts it. Exits with 0, 1 (failed) or 2 (usage).
 */
#include "base/program.h"
#include "io/decode/decode.h"
#include "io/read/mesh_child.h"
#include "io/openmesh.h"

#include <string.h>
#include <sys/resource.h>

static const rlim_t memory_bytes = (rlim_t)1536 << 20;

int main(int argument_count, char **arguments)
{
    mesh m;
    error err = {""};
    if (argument_count != 2) {
        fprintf(stderr, "usage: marotte-meshload FILE | --decode\n");
        return 2;
    }
    program_limit(RLIMIT_CORE, 0, 0);
    bool decodes = strcmp(arguments[1], MESH_CHILD_DECODE) == 0;
    rlim_t patience_s = decodes ? 10 : 3;
    /* SIGXCPU, which identifies the limit, comes one second before SIGKILL. */
    program_limit(RLIMIT_CPU, patience_s, patience_s + 1);
    program_limit(RLIMIT_AS, memory_bytes, memory_bytes);
    if (decodes)
        return decode_serve(stdin, stdout) ? 0 : 1;
    mrt_result result = openmesh_read_unsafe(&m, arguments[1], &err);
    if (result < 0)
        mesh_wire_write_failure(stdout, err.text);
    else
        mesh_wire_write(stdout, &m);
    mesh_destroy(&m);
    return fflush(stdout) == 0 && result == MRT_OK ? 0 : 1;
}
