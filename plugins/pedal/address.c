#include "address.h"

#include <stddef.h>
#include <string.h>

/* Parses exactly four hex digits, then `end`. */
static bool parse_id(const char **text, char end, uint16_t *out)
{
    uint32_t number = 0;
    for (int i = 0; i < 4; ++i) {
        static const char digits[] = "0123456789abcdef";
        char c = *(*text)++;
        if (c >= 'A' && c <= 'F')
            c = (char)(c - 'A' + 'a');
        const char *digit = c ? strchr(digits, c) : NULL;
        if (!digit)
            return false;
        number = number * 16 + (uint32_t)(digit - digits);
    }
    *out = (uint16_t)number;
    return *(*text)++ == end;
}

/* Parses 1..3 digits without a leading zero. */
static bool parse_port(const char **text, uint32_t *out)
{
    uint32_t number = 0;
    int length = 0;
    if (**text == '0')
        return false;
    for (; **text >= '0' && **text <= '9' && length < 4; ++length)
        number = number * 10 + (uint32_t)(*(*text)++ - '0');
    *out = number;
    return length >= 1 && length <= 3 && number <= 255;
}

static bool is_path(const char *text)
{
    uint32_t number;
    if (!parse_port(&text, &number) || *text++ != '-')
        return false;
    for (int depth = 0; depth < 7; ++depth) {
        if (!parse_port(&text, &number))
            return false;
        if (*text == '\0')
            return true;
        if (*text++ != '.')
            return false;
    }
    return false;
}

bool address_parse(address *out, const char *text)
{
    static const char prefix[] = "usb:";
    *out = (address){0};
    if (!text || text[0] == '\0')
        return true;
    if (strncmp(text, prefix, sizeof prefix - 1) != 0)
        return false;
    const char *rest = text + sizeof prefix - 1;
    if (is_path(rest) && strlen(rest) < ADDRESS_PATH) {
        out->kind = ADDRESS_PORT;
        memcpy(out->path, rest, strlen(rest) + 1);
        return true;
    }
    out->kind = ADDRESS_KIND;
    return parse_id(&rest, ':', &out->vendor) && parse_id(&rest, '\0', &out->product);
}

int address_compare_paths(const char *a, const char *b)
{
    for (;;) {
        uint32_t left = 0, right = 0;
        for (; *a >= '0' && *a <= '9'; ++a)
            left = left * 10 + (uint32_t)(*a - '0');
        for (; *b >= '0' && *b <= '9'; ++b)
            right = right * 10 + (uint32_t)(*b - '0');
        if (left != right)
            return left < right ? -1 : 1;
        if (*a == '\0' || *b == '\0')
            return (*a != '\0') - (*b != '\0');
        ++a;
        ++b;
    }
}

bool address_matches(const address *wanted, const address_binding *binding, const char *path,
                     uint16_t vendor, uint16_t product, bool is_known)
{
    if (binding->is_bound)
        return vendor == binding->vendor && product == binding->product &&
               strcmp(path, binding->path) == 0;
    switch (wanted->kind) {
    case ADDRESS_KIND:
        return vendor == wanted->vendor && product == wanted->product;
    case ADDRESS_PORT:
        return strcmp(path, wanted->path) == 0;
    default:
        return is_known;
    }
}
