/* Threads that share a library and a scene of the C interface: each is told its own errors.
 * c_threads SCENE; exit status 0 where everything is as it should be. */
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <withy/withy.h>

enum { THREADS = 4 };
static withy_library* shared_library;
static withy_scene* shared_scene;

/* Each thread fails by a text of its own and a scene of all, and goes well now and then. */
static void* fail_often(void* argument) {
  int* wrong = argument;
  char name[64];
  int i;
  sprintf(name, "text-%p", argument);
  for (i = 0; i < 2000; ++i) {
    withy_scene* mine = NULL;
    withy_simulation* simulation = NULL;
    const int good = i % 7 == 0;
    if (withy_scene_parse(shared_library, good ? "format: withy/1" : "{a: [}", name, &mine) !=
        (good ? WITHY_OK : WITHY_BAD_INPUT))
      ++*wrong;
    if (good ? strlen(withy_error(shared_library)) > 0 : strncmp(withy_error(shared_library), name, strlen(name)) != 0)
      ++*wrong;
    if (withy_simulation_create(shared_scene, &simulation) != WITHY_BAD_INPUT) ++*wrong;
    if (strstr(withy_error(shared_scene), "lenght") == NULL) ++*wrong;
    withy_free(mine);
  }
  return NULL;
}

int main(int argc, char** argv) {
  pthread_t threads[THREADS];
  int wrong[THREADS] = {0}, all = 0, i;
  if (argc != 2) return 2;
  if (withy_library_create(NULL, &shared_library) != WITHY_OK) return 2;
  if (withy_scene_read(shared_library, argv[1], &shared_scene) != WITHY_OK) return 2;
  if (withy_scene_set(shared_scene, "bodies.link1.lenght", "1") != WITHY_OK) return 2;
  for (i = 0; i < THREADS; ++i)
    if (pthread_create(&threads[i], NULL, fail_often, &wrong[i]) != 0) return 2;
  for (i = 0; i < THREADS; ++i)
    if (pthread_join(threads[i], NULL) != 0) return 2;
  for (i = 0; i < THREADS; ++i) all += wrong[i];
  if (strcmp(withy_error(shared_scene), "") != 0) ++all; /* no call of this thread has failed */
  withy_free(shared_scene);
  withy_free(shared_library);
  printf("%d errors of another thread, or none\n", all);
  return all == 0 ? 0 : 1;
}
