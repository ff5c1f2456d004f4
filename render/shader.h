// OpenGL objects that free themselves, and shader programs. Only for the .cpp files of render/; a context must be current.
#pragma once

#include <epoxy/gl.h>

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <utility>

#include "render/camera.h"

namespace render {

// A GL name that is deleted with its owner.
template <void (*Delete)(GLuint)>
class GlName {
 public:
  GlName() = default;
  explicit GlName(GLuint name) : name_(name) {}
  GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlName& operator=(GlName&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlName() {
    if (name_) Delete(name_);
  }
  operator GLuint() const { return name_; }

 private:
  GLuint name_ = 0;
};
inline void delete_buffer(GLuint name) { glDeleteBuffers(1, &name); }
inline void delete_vertex_array(GLuint name) { glDeleteVertexArrays(1, &name); }
inline void delete_texture(GLuint name) { glDeleteTextures(1, &name); }
inline void delete_framebuffer(GLuint name) { glDeleteFramebuffers(1, &name); }
inline void delete_program(GLuint name) { glDeleteProgram(name); }
using Buffer = GlName<delete_buffer>;
using VertexArray = GlName<delete_vertex_array>;
using Texture = GlName<delete_texture>;
using Framebuffer = GlName<delete_framebuffer>;
using Program = GlName<delete_program>;

Buffer make_buffer();
VertexArray make_vertex_array();
Framebuffer make_framebuffer();
// Nearest filter, clamped to the edge.
Texture make_texture(GLenum internal_format, int width, int height, GLenum format, GLenum type, const void* pixels = nullptr);

// Compiles two of the files in assets/shaders, which are built into the library. Throws std::runtime_error with the driver's message.
Program make_program(std::string_view vertex_file, std::string_view fragment_file);

// The source of a file in assets/shaders; throws where there is none. (Defined in the generated embedded.cpp.)
std::string_view shader_source(std::string_view file);

void set(const Program& program, const char* name, int value);
void set(const Program& program, const char* name, float value);
void set(const Program& program, const char* name, const Eigen::Vector2f& value);
void set(const Program& program, const char* name, const Eigen::Vector3f& value);
void set(const Program& program, const char* name, const Eigen::Vector4f& value);
void set(const Program& program, const char* name, const Eigen::Matrix4f& value);
// Binds the texture to the unit and points the sampler at it.
void set(const Program& program, const char* name, const Texture& texture, int unit);

// The uniforms that every program of the scene takes: view, projection, perspective, unproject and middle (see section.frag).
void set_uniforms(const Program& program, const Projection& projection);

// Draws one triangle that covers the whole picture, for programs made with screen.vert.
void draw_screen(const VertexArray& empty);

}  // namespace render
