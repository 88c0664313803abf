// How the command takes memory from the system.
#pragma once

namespace sfumato::cli {

/// Arrays of a cloud and of a picture come and go by the tens of megabytes. By default glibc hands each back
/// to the system and takes the next page by page, which is a quarter to two fifths of the time of a picture
/// where a virtual machine has to fetch them. Its settings are read when a program starts and only then:
/// where the user has none (GLIBC_TUNABLES), this program starts itself once more with ours, or goes on
/// without them. Programs that it starts do not inherit them.
void allocate_in_large_pages(char** argv);

}  // namespace sfumato::cli
