/* A shim for LD_PRELOAD: what would happen if the n-th call that changes a folder failed, or if the
   process were killed in it. faults_arm() starts the count, faults_count() tells it. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static char folder[PATH_MAX];
static long left = 0, count = 0;
static int failure = 0; /* an errno, or 0 to kill */

void faults_arm(const char* path, long at, int error) {
  snprintf(folder, sizeof folder, "%s", path);
  left = at, count = 0, failure = error;
}
long faults_count(void) { return count; }

static int inside(const char* path) {
  char whole[PATH_MAX];
  if (!folder[0]) return 0;
  if (path[0] == '/')
    snprintf(whole, sizeof whole, "%s", path);
  else {
    if (!getcwd(whole, sizeof whole)) return 0;
    size_t n = strlen(whole);
    snprintf(whole + n, sizeof whole - n, "/%s", path);
  }
  return strncmp(whole, folder, strlen(folder)) == 0;
}
static int is_inside(int fd) {
  char link[64], path[PATH_MAX];
  if (!folder[0]) return 0;
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  ssize_t n = readlink(link, path, sizeof path - 1);
  if (n <= 0) return 0;
  path[n] = 0;
  return inside(path);
}
/* Count a call; true if it is to fail now. */
static int due(int there) {
  if (!there) return 0;
  ++count;
  if (left == 0 || --left > 0) return 0;
  if (failure == 0) kill(getpid(), SIGKILL);
  errno = failure;
  return 1;
}
#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int fd, const void* data, size_t size) {
  if (left == 1 && is_inside(fd)) REAL(write)(fd, data, size / 2); /* a torn write */
  return due(is_inside(fd)) ? -1 : REAL(write)(fd, data, size);
}
ssize_t pwrite(int fd, const void* data, size_t size, off_t at) {
  return due(is_inside(fd)) ? -1 : REAL(pwrite)(fd, data, size, at);
}
ssize_t pwrite64(int fd, const void* data, size_t size, off64_t at) {
  return due(is_inside(fd)) ? -1 : REAL(pwrite64)(fd, data, size, at);
}
int fsync(int fd) { return due(is_inside(fd)) ? -1 : REAL(fsync)(fd); }
int ftruncate(int fd, off_t size) { return due(is_inside(fd)) ? -1 : REAL(ftruncate)(fd, size); }
int ftruncate64(int fd, off64_t size) {
  return due(is_inside(fd)) ? -1 : REAL(ftruncate64)(fd, size);
}
int rename(const char* from, const char* to) {
  return due(inside(to)) ? -1 : REAL(rename)(from, to);
}
int unlink(const char* path) { return due(inside(path)) ? -1 : REAL(unlink)(path); }
int mkdir(const char* path, mode_t mode) {
  return due(inside(path)) ? -1 : REAL(mkdir)(path, mode);
}
static int opens(const char* path, int flags) { return (flags & O_CREAT) && inside(path); }
int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  mode_t mode = (flags & O_CREAT) ? va_arg(rest, int) : 0;
  va_end(rest);
  return due(opens(path, flags)) ? -1 : REAL(open)(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  mode_t mode = (flags & O_CREAT) ? va_arg(rest, int) : 0;
  va_end(rest);
  return due(opens(path, flags)) ? -1 : REAL(open64)(path, flags, mode);
}
