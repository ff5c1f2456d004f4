#include "render/shader.h"

#include <stdexcept>
#include <vector>

namespace render {

Buffer make_buffer() {
  GLuint name = 0;
  glGenBuffers(1, &name);
  return Buffer(name);
}

VertexArray make_vertex_array() {
  GLuint name = 0;
  glGenVertexArrays(1, &name);
  return VertexArray(name);
}

Framebuffer make_framebuffer() {
  GLuint name = 0;
  glGenFramebuffers(1, &name);
  return Framebuffer(name);
}

Texture make_texture(GLenum internal_format, int width, int height, GLenum format, GLenum type, const void* pixels) {
  GLuint name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_2D, name);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal_format), width, height, 0, format, type, pixels);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return Texture(name);
}

namespace {

GLuint compile(GLenum kind, std::string_view file) {
  const std::string_view source = shader_source(file);
  const char* text = source.data();
  const auto length = static_cast<GLint>(source.size());
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &text, &length);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return shader;
  std::vector<char> log(4096);
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  glDeleteShader(shader);
  throw std::runtime_error("shader '" + std::string(file) + "' does not compile: " + log.data());
}

GLint location(const Program& program, const char* name) { return glGetUniformLocation(program, name); }

}  // namespace

Program make_program(std::string_view vertex_file, std::string_view fragment_file) {
  Program program(glCreateProgram());
  const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_file), fragment = compile(GL_FRAGMENT_SHADER, fragment_file);
  glAttachShader(program, vertex);
  glAttachShader(program, fragment);
  glLinkProgram(program);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  GLint ok = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  if (ok) return program;
  std::vector<char> log(4096);
  glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw std::runtime_error("shaders '" + std::string(vertex_file) + "' and '" + std::string(fragment_file) +
                           "' do not link: " + log.data());
}

void set(const Program& program, const char* name, int value) { glUniform1i(location(program, name), value); }
void set(const Program& program, const char* name, float value) { glUniform1f(location(program, name), value); }
void set(const Program& program, const char* name, const Eigen::Vector2f& value) { glUniform2fv(location(program, name), 1, value.data()); }
void set(const Program& program, const char* name, const Eigen::Vector3f& value) { glUniform3fv(location(program, name), 1, value.data()); }
void set(const Program& program, const char* name, const Eigen::Vector4f& value) { glUniform4fv(location(program, name), 1, value.data()); }
void set(const Program& program, const char* name, const Eigen::Matrix4f& value) {
  glUniformMatrix4fv(location(program, name), 1, GL_FALSE, value.data());
}

void set(const Program& program, const char* name, const Texture& texture, int unit) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, texture);
  glUniform1i(location(program, name), unit);
}

void set_uniforms(const Program& program, const Projection& projection) {
  const Eigen::Matrix4f& m = projection.projection;
  set(program, "view", projection.view);
  set(program, "projection", m);
  set(program, "perspective", static_cast<int>(projection.perspective));
  set(program, "unproject", Eigen::Vector2f(1 / m(0, 0), 1 / m(1, 1)));
  // Orthographic: the constant column; perspective: the z column, divided by -z.
  set(program, "middle", projection.perspective ? Eigen::Vector2f(-m(0, 2), -m(1, 2)) : Eigen::Vector2f(m(0, 3), m(1, 3)));
}

void draw_screen(const VertexArray& empty) {
  glBindVertexArray(empty);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace render
